// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/certify.hpp"

#include <algorithm>
#include <exception>
#include <mutex>

#include "canonical.hpp"
#include "check_options.hpp"
#include "reflectree/error.hpp"
#include "reflectree/math/random.hpp"
#include "slab_proof.hpp"

namespace reflectree {

namespace {

using namespace detail;

// In order of the partition; slabs of one coordinate are packed in order of the cosine.
std::vector<SlabProof> slabs_of(const SamplerData& data, const PackedSampler& packed) {
  std::vector<SlabProof> slabs;
  const std::vector<float>& borders = packed.exact.lookup.borders();
  const std::vector<SlabBox> boxes = slab_boxes(data.exact_partition);
  const std::size_t axes = data.exact_partition.coordinates.size(), of_viewer = axes - data.parameters.size();
  for (std::size_t s = 0; s < boxes.size(); ++s) {
    const std::size_t i = axes == 1 ? boxes.size() - 1 - s : s;
    KnownRange known{};
    if (axes == 1) {
      known.lo = borders[i], known.hi = min(borders[i + 1], 1.f);
    } else {  // as SlabTree compares them
      known.lo = max(std::cos(boxes[s].hi[0]), min_cos_theta_o), known.hi = std::cos(boxes[s].lo[0]);
    }
    for (std::size_t k = 1; k < axes; ++k) {
      float lo = boxes[s].lo[k], hi = boxes[s].hi[k];
      if (k >= of_viewer) {
        const KnownParameter& parameter = data.parameters[k - of_viewer];
        lo = value_of(parameter, lo), hi = value_of(parameter, hi);
      }
      known.beyond[k - 1] = {double(lo), double(hi)};
    }
    const PackedSlab& slab = packed.exact.slabs[i];
    const auto first = packed.exact.leaves.begin() + std::ptrdiff_t(slab.first);
    SlabProof proof{known, {first, first + std::ptrdiff_t(slab.count)}, {}, data.exact[s]};
    proof.proofs.resize(slab.count);
    slabs.push_back(std::move(proof));
  }
  return slabs;
}

void check(const CertifyOptions& o) {
  if (o.tolerance > 0 && o.tolerance <= 1 && o.loosest >= o.tolerance && o.loosest <= 1 &&
      o.boxes_per_leaf >= 1 && o.trials >= 1)
    return;
  throw Error("tolerance and loosest are not in (0, 1], trials are below 1, or there is no box to look at",
              "certification", "take the defaults");
}

// An enclosure may be that of another function, as when traits are copied: values at points tell.
void check_enclosure(const EnclosedField& field, const std::vector<SlabProof>& slabs) {
  constexpr int points = 16;
  Pcg32 u(17);
  for (const SlabProof& slab : slabs) {
    const ProofBox whole = field.whole(slab.known);
    for (int i = 0; i < points; ++i) {
      const PackedLeaf& leaf = slab.leaves[u() % slab.leaves.size()];
      ProofPoint at{};
      for (std::size_t k = 0; k < field.axes(); ++k) {
        at[k] = k == 1 || k == 2 ? double(to_unit_float(u()))
                                 : linear_mix(to_unit_double(u()), whole.lo[k], whole.hi[k]);
      }
      ProofBox box{at, at};
      box.lo[star_axis] = whole.lo[star_axis], box.hi[star_axis] = whole.hi[star_axis];
      check_value(field.over(box, slab.known, leaf), field.at(at, slab.known, leaf));
    }
  }
}

struct Task {
  std::uint32_t slab, leaf;
};

// A leaf's bound may be looser where that takes next to no trials of its slab.
double affordable(const SlabProof& slab, std::size_t leaf, double loosest) {
  constexpr double share = 0.002;  // of the slab's trials
  const double volume = double(area_of(slab.leaves[leaf])) * double(slab.leaves[leaf].height);
  return std::max(loosest, 1 + share / volume);
}

// Replaces the proofs of leaves that have none, or by lower bounds. progress: where it begins and ends.
void prove(std::vector<SlabProof>& slabs, const std::vector<Task>& tasks, const EnclosedField& field,
           const ProofLimits& limits, const Host& host, float progress, float progress_end) {
  // The error of the first leaf wins, so that the message does not depend on the threads.
  std::mutex mutex;
  std::size_t first_bad = tasks.size();
  std::exception_ptr error;
  constexpr std::size_t batch = 64;
  for (std::size_t first = 0; first < tasks.size() && !error; first += batch) {
    if (host.cancelled()) throw Cancelled();
    host.progress(linear_mix(float(first) / float(tasks.size()), progress, progress_end));
    host.parallel_for(std::min(batch, tasks.size() - first), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = first + begin; t < first + end; ++t) {
        SlabProof& slab = slabs[tasks[t].slab];
        LeafProof& kept = slab.proofs[tasks[t].leaf];
        try {
          ProofLimits of_leaf = limits;
          of_leaf.loosest = affordable(slab, tasks[t].leaf, limits.loosest);
          LeafProof proof = prove_leaf(field, slab.known, slab.leaves[tasks[t].leaf], of_leaf);
          proof.boxes += kept.boxes;
          proof.seen = std::max(proof.seen, kept.seen);
          const bool better = !kept.proved || (proof.proved && proof.bound < kept.bound);
          if (!better) proof.proved = kept.proved, proof.bound = kept.bound;
          kept = proof;
        } catch (...) {
          const std::lock_guard<std::mutex> lock(mutex);
          if (t < first_bad) first_bad = t, error = std::current_exception();
        }
      }
    });
  }
  if (error) std::rethrow_exception(error);
}

// Of a proved slab whose trials rose above `trials` the leaves that are worth another look: those that gain most
// for the boxes that they took, until it is enough.
void add_loose_leaves(const SlabProof& slab, std::uint32_t index, double trials, const ProofLimits& limits,
                      std::vector<Task>& tasks) {
  struct Gain {
    double gain, rate;
    std::uint32_t leaf;
  };
  if (!slab.proved() || !(slab.trials_before() <= trials) || slab.trials() <= trials) return;
  std::vector<Gain> gains;
  for (std::uint32_t k = 0; k < slab.leaves.size(); ++k) {
    const LeafProof& proof = slab.proofs[k];
    const double area = double(area_of(slab.leaves[k])), height = double(slab.leaves[k].height);
    const double gain = area * (proof.bound - std::max(height, proof.seen * (1 + limits.tolerance)));
    if (gain > 0) gains.push_back({gain, gain / double(proof.boxes), k});
  }
  std::stable_sort(gains.begin(), gains.end(), [](const Gain& a, const Gain& b) { return a.rate > b.rate; });
  constexpr double safety = 1.2;
  double missing = safety * (slab.trials() - trials);
  for (const Gain& g : gains) {
    if (missing <= 0) return;
    tasks.push_back({index, g.leaf});
    missing -= g.gain;
  }
}

constexpr const char* note_stem = "proof: ";

// The slab's tree with its bounds.
void raise(MajorantTree& tree, const SlabProof& slab) {
  const bool halved = slab.leaves.size() > tree.mass.size();
  static_cast<CanonicalTree&>(tree) = slab.tree;
  std::vector<double> volumes;
  bool raised = halved;
  for (std::size_t k = 0; k < slab.leaves.size(); ++k) {
    const double bound = slab.bound(k);
    volumes.push_back(double(area_of(slab.leaves[k])) * bound);
    raised = raised || bound > double(slab.leaves[k].height);
  }
  if (raised) set_volumes(tree, volumes);
}

}  // namespace

std::string no_proof(const AnyBrdf& f) {
  const BrdfTraits& traits = f.traits();
  if (!traits.enclosure)
    return "no interval form: it is known at points alone; models, MERL tables, fits, sums of them, "
           "and functions with bound() or lipschitz() have one";
  if (traits.channels != 1 && traits.channels != 3 && !traits.enclosure->reduces_channels())
    return "no interval form of a function of this many channels";
  return "";
}

std::string no_proof(const AnyFamily& family) {
  if (!family.enclosure()) {
    return "no interval form of this family: models whose numbers vary have one, where no azimuth varies and "
           "two "
           "widths do not meet";
  }
  if (family.channels() != 1 && family.channels() != 3)
    return "no interval form of a function of this many channels";
  return "";
}

namespace {

// f: a function or a family.
template <class F>
Certification certify_any(SamplerData& data, const F& f, const CertifyOptions& options,
                          const Host& the_host) {
  check(options);
  Host host = completed(the_host);
  if (!f.traits().concurrent) host.parallel_for = Host().parallel_for;
  const std::string refusal = no_proof(f);
  if (!refusal.empty()) throw Error(refusal, data.material, "its bounds stay estimated");
  host.stage("proving the bounds");
  const PackedSampler packed = pack(data);
  const EnclosedField field(f, packed);
  std::vector<SlabProof> slabs = slabs_of(data, packed);
  check_enclosure(field, slabs);
  std::vector<Task> tasks;
  for (std::uint32_t s = 0; s < slabs.size(); ++s) {
    for (std::uint32_t k = 0; k < slabs[s].leaves.size(); ++k) tasks.push_back({s, k});
  }
  ProofLimits limits{options.tolerance, 1 + options.loosest, options.boxes_per_leaf};
  prove(slabs, tasks, field, limits, host, 0, 0.8f);
  for (int round = 0; round < 2; ++round) {
    limits = {limits.tolerance / 4, 1 + (limits.loosest - 1) / 4, limits.boxes};
    tasks.clear();
    for (std::uint32_t s = 0; s < slabs.size(); ++s)
      add_loose_leaves(slabs[s], s, options.trials, limits, tasks);
    prove(slabs, tasks, field, limits, host, 0.8f + 0.1f * float(round), 0.9f + 0.1f * float(round));
  }
  constexpr double rounding = 1e-6;  // of the tree's own sum
  std::vector<char> were_below;
  for (const SlabProof& slab : slabs) were_below.push_back(slab.trials_before() <= options.trials);
  host.parallel_for(slabs.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      SlabProof& slab = slabs[s];
      if (were_below[s]) halve_leaves(slab, options.trials * (1 - rounding), field, limits);
    }
  });

  Certification out;
  SamplerData proved = data;
  std::erase_if(proved.report.notes, [](const std::string& note) { return note.starts_with(note_stem); });
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    const SlabProof& slab = slabs[s];
    MajorantTree& tree = proved.exact[s];
    double ratio = 0;
    std::size_t open = 0;
    for (std::size_t k = 0; k < slab.proofs.size(); ++k) {
      const LeafProof& p = slab.proofs[k];
      ++out.leaves, out.boxes += p.boxes;
      if (!p.proved) ++open;
      // Of leaves that lie at the floor nothing is asked.
      if (p.proved && p.bound > double(slab.leaves[k].height)) ++out.raised_leaves;
      if (p.proved && p.seen > 0 && p.bound > 1.01 * double(floor_share))
        ratio = std::max(ratio, p.bound / p.seen);
    }
    out.proved_leaves += slab.proofs.size() - open;
    ++out.slabs;
    tree.status = open == 0 ? BoundStatus::certified : BoundStatus::estimated;
    tree.bound_ratio = open == 0 ? float(ratio) : 0;
    raise(tree, slab);
    if (open > 0) continue;
    ++out.certified_slabs;
    out.largest_ratio = std::max(out.largest_ratio, ratio);
  }
  proved.report.expected_trials = 0;
  for (const MajorantTree& tree : proved.exact)
    proved.report.expected_trials = max(proved.report.expected_trials, tree.volume);
  if (out.certified_slabs == out.slabs) {
    proved.report.overshoot_mass = 0;
  } else {
    proved.report.notes.push_back(note_stem + std::to_string(out.leaves - out.proved_leaves) + " of " +
                                  std::to_string(out.leaves) + " leaves are open; " +
                                  std::to_string(out.slabs - out.certified_slabs) + " of " +
                                  std::to_string(out.slabs) + " slabs keep their estimated bounds");
  }
  data = std::move(proved);
  host.progress(1);
  return out;
}

}  // namespace

Certification certify(SamplerData& data, const AnyBrdf& f, const CertifyOptions& options, const Host& host) {
  return certify_any(data, f, options, host);
}
Certification certify(SamplerData& data, const AnyFamily& family, const CertifyOptions& options,
                      const Host& host) {
  return certify_any(data, family, options, host);
}

}  // namespace reflectree
