// SPDX-License-Identifier: Apache-2.0
#include "work.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <mutex>

#include "reflectree/error.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/picture/image_compare.hpp"
#include "ways.hpp"

namespace reflectree::pictures {

using namespace render;

namespace {

constexpr const char* combined_samplers[] = {"exact", "one-shot", "one-shot-monotone"};

std::uint64_t seed_of(const Plan& plan, int round) { return plan.seed * 1000 + 1 + std::uint64_t(round); }
std::uint64_t reference_seed(const Plan& plan) { return plan.seed * 1000; }

// As many directions per pixel at the first surface, whatever the method.
Method method_of(const std::string& name, const Plan& plan) {
  Method m;
  m.samples = plan.samples;
  if (name == "recursive") {
    const int split = std::max(1, int(std::lround(std::sqrt(double(plan.samples)))));
    m.transport.method = Transport::Method::recursive, m.transport.split = split;
    m.samples = std::max(1, plan.samples / split);
  }
  if (name == "photons") m.transport.method = Transport::Method::photons, m.transport.split = 1;
  return m;
}

class Progress {
 public:
  Progress(std::string label, std::size_t of) : label_(std::move(label)), of_(of) {}
  void step() {
    const std::lock_guard lock(mutex_);
    const double took = std::chrono::duration<double>(Clock::now() - start_).count();
    ++done_;
    std::fprintf(stderr, "%s: %zu of %zu, %.0f s, %.0f s left\n", label_.c_str(), done_, of_, took,
                 took / double(done_) * double(of_ - done_));
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::mutex mutex_;
  std::string label_;
  std::size_t of_, done_ = 0;
  Clock::time_point start_ = Clock::now();
};

class SceneStudy {
 public:
  SceneStudy(Results& results, const Plan& plan, const Place& place, const Setting& setting)
      : results_(results), plan_(plan), place_(place), setting_(setting) {}

  void run() {
    load_all();
    const Scene& ours = scene_of("one-shot");
    const Reference reference = reference_of(converged("path", ours, Method{}));
    save(reference.image, "reference", nullptr);
    for (const std::string& name : methods()) {
      if (is_wanted(plan_, name)) measure_all(name, reference);
    }
    if (setting_.combined && is_wanted(plan_, "ways")) combine();
  }

 private:
  struct PictureSubject {
    std::string name;
    std::optional<Scene> scene;
    std::string why;  // there is none
  };
  struct Job {
    const Scene* scene;  // as it was loaded
    Method method;
    bool divided;  // N directions are
    int timed_samples;
    PictureCell cell;
    const Reference* reference;
  };

  void load_all() {
    for (const SamplerInfo& info : samplers()) {
      const bool combined =
          setting_.combined && std::find(std::begin(combined_samplers), std::end(combined_samplers),
                                         info.name) != std::end(combined_samplers);
      if (is_wanted(plan_, "path", info.name) || info.name == "one-shot" || combined)
        subjects_.push_back({std::string(info.name), {}, {}});
    }
    Progress progress(std::string(setting_.name) + ", samplers", subjects_.size());
    for_each_job(place_.threads, subjects_.size(), [&](std::size_t i) {
      PictureSubject& s = subjects_[i];
      try {
        s.scene = load(setting_, place_.scenes, s.name, place_.host);
        s.scene->width = plan_.width, s.scene->height = plan_.height;
      } catch (const Error& error) {
        s.why = error.what();
      }
      progress.step();
    });
    for (const PictureSubject& s : subjects_) {
      if (!s.scene) results_.absences.push_back({setting_.name, "path", s.name, s.why});
    }
  }

  const Scene& scene_of(const std::string& sampler) const {
    for (const PictureSubject& s : subjects_) {
      if (s.name == sampler && s.scene) return *s.scene;
    }
    throw Error("there is no sampler " + sampler, setting_.name, "see the messages above");
  }

  // By all threads; a film that was kept is gone on with.
  Film converged(const std::string& name, const Scene& scene, const Method& method) const {
    Film film;
    const std::string path = place_.film(std::string(setting_.name) + "-" + name);
    if (std::filesystem::exists(path)) film = load_film(path);
    RenderOptions how;
    how.samples = plan_.reference, how.seed = reference_seed(plan_), how.technique = method.technique;
    std::fprintf(stderr, "%s, %s: converged picture\n", setting_.name, name.c_str());
    const bool done =
        render_into(film, prepared(scene, method), how, with_threads(place_.threads, place_.host));
    if (film.samples > 0) save_film(path, film);
    if (!done) throw Cancelled();
    return film;
  }

  void save(const Image& image, const std::string& name, const Image* reference) const {
    if (!setting_.pictured) return;
    write_png(place_.folder + "/" + picture_file(setting_, name, false), image);
    if (reference)
      write_png(place_.folder + "/" + picture_file(setting_, name, true),
                difference_map(image, *reference, 2, .5));
  }

  bool is_there(const PictureCell& cell) const {
    for (const PictureCell* c : results_.of(cell.scene, cell.method, cell.sampler)) {
      if (c->round == cell.round) return true;
    }
    return false;
  }

  void measure_all(const std::string& name, const Reference& reference) {
    const Method method = method_of(name, plan_);
    std::vector<const PictureSubject*> wanted;
    for (const PictureSubject& s : subjects_) {
      if (s.scene && is_wanted(plan_, name, s.name)) wanted.push_back(&s);
    }
    std::vector<double> seconds(wanted.size());
    double ours = 0;
    for_each_job(place_.threads, wanted.size(), [&](std::size_t i) {
      seconds[i] = seconds_per_sample(prepared(*wanted[i]->scene, method), method, place_.host);
      if (wanted[i]->name == plan_.ours) ours = seconds[i];
    });
    const int rounds = name == "path" ? plan_.rounds : plan_.other_rounds;
    std::vector<Job> jobs;
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t i = 0; i < wanted.size(); ++i) {
        const auto others = results_.of(setting_.name, name, wanted[i]->name);
        int timed = wanted[i]->name == plan_.ours
                        ? method.samples
                        : std::max(1, int(std::lround(method.samples * ours / seconds[i])));
        if (!others.empty()) timed = others.front()->timed.samples;
        const PictureCell cell{setting_.name, name, wanted[i]->name, round, {}, {}};
        if (!is_there(cell)) jobs.push_back({&*wanted[i]->scene, method, true, timed, cell, &reference});
      }
    }
    do_all(name, jobs);
  }

  void combine() {
    Method direct;
    direct.transport.method = Transport::Method::direct;
    const Scene& scene = scene_of("one-shot");
    Film seen;
    RenderOptions few;
    few.samples = 16;
    render_into(seen, sampled_part(scene), few);
    std::vector<char> mask;
    for (std::size_t i = 0; i < seen.sums.size(); i += 6) mask.push_back(seen.sums[i] > .5 * seen.samples);
    const Reference reference = reference_of(converged("direct", scene, direct), std::move(mask));
    std::vector<Job> jobs;
    for (const char* sampler : combined_samplers) {
      for (const Way& way : ways()) {
        if (!is_shown(way, sampler)) continue;
        const Method method = pictures::method_of(way, plan_.directions);
        for (int round = 0; round < plan_.rounds; ++round) {
          const PictureCell cell{setting_.name, way.name, sampler, round, {}, {}};
          if (!is_there(cell))
            jobs.push_back({&scene_of(sampler), method, way.divided, method.samples, cell, &reference});
        }
      }
    }
    std::stable_sort(jobs.begin(), jobs.end(),
                     [](const Job& a, const Job& b) { return a.cell.round < b.cell.round; });
    do_all("ways", jobs);
  }

  void do_all(const std::string& name, std::vector<Job>& jobs) {
    Progress progress(std::string(setting_.name) + ", " + name, jobs.size());
    for_each_job(place_.threads, jobs.size(), [&](std::size_t i) {
      Job& job = jobs[i];
      const bool pictured = name == "path" && job.cell.round == 0;
      Scene scene = prepared(*job.scene, job.method);
      if (!job.divided) scene = undivided(std::move(scene));
      Image image;
      measure(job.cell, scene, job.method, job.timed_samples, seed_of(plan_, job.cell.round), *job.reference,
              place_.host, pictured ? &image : nullptr);
      const auto shown = shown_samplers();
      if (pictured && std::find(shown.begin(), shown.end(), job.cell.sampler) != shown.end())
        save(image, job.cell.sampler, &job.reference->image);
      {
        const std::lock_guard lock(mutex_);
        results_.cells.push_back(job.cell);
        keep(place_.cells(), results_);
      }
      progress.step();
    });
  }

  Results& results_;
  const Plan& plan_;
  const Place& place_;
  const Setting& setting_;
  std::vector<PictureSubject> subjects_;
  std::mutex mutex_;
};

}  // namespace

std::string key_of(const Plan& p) {
  char text[200];
  std::snprintf(text, sizeof text,
                "pictures 1: %d x %d, %d samples, %d directions, reference %d, seed %llu, ours %s", p.width,
                p.height, p.samples, p.directions, p.reference, static_cast<unsigned long long>(p.seed),
                p.ours.c_str());
  return text;
}

void study_scene(Results& results, const Plan& plan, const Place& place, const Setting& setting) {
  SceneStudy(results, plan, place, setting).run();
}

}  // namespace reflectree::pictures
