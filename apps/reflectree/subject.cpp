// SPDX-License-Identifier: Apache-2.0
#include "subject.hpp"

#include <chrono>

#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree::cli {

namespace {

Target parse_target(const std::string& text) {
  if (text == "norm") return {TargetKind::norm, 0};
  if (text == "luminance") return {TargetKind::luminance, 0};
  if (text == "maximum") return {TargetKind::maximum, 0};
  if (text.rfind("channel:", 0) == 0) {
    std::string_view rest = std::string_view(text).substr(8);
    const auto number = take_number(rest);
    if (number && rest.empty() && *number >= 0 && *number < float(max_channels) &&
        *number == float(int(*number))) {
      return {TargetKind::channel, std::uint16_t(*number)};
    }
  }
  throw Error("no target '" + text + "'", "--target", "write norm, luminance, maximum, or channel:K");
}

std::optional<Domain> parse_domain(const std::string& text) {
  if (text == "auto") return std::nullopt;
  const std::string_view word = std::string_view(text).substr(0, text.find(':'));
  for (const DomainKind kind :
       {DomainKind::projected_disk, DomainKind::equal_area, DomainKind::half_vector, DomainKind::back_vector,
        DomainKind::mirror_vector, DomainKind::normal_vector}) {
    if (text == name_of(kind)) return Domain{kind, Symmetry::mirror, 0};
  }
  if (word == name_of(DomainKind::stretched)) {
    float exponent = 1.5f;
    if (word.size() < text.size()) {
      std::string_view rest = std::string_view(text).substr(word.size() + 1);
      const auto number = take_number(rest);
      if (!number || !rest.empty() || !(*number >= 0 && *number < 2)) {
        throw Error("no exponent in '" + text + "'", "--domain",
                    "write stretched:A with A from 0 to below 2");
      }
      exponent = *number;
    }
    return Domain{DomainKind::stretched, Symmetry::mirror, exponent};
  }
  throw Error("no domain '" + text + "'", "--domain",
              "write auto, projected_disk, equal_area, half_vector, back_vector, mirror_vector, "
              "normal_vector, or stretched:A");
}

void check_target(const Target& target, const AnyBrdf& f) {
  if (target.kind != TargetKind::channel || int(target.index) < f.channels()) return;
  throw Error(
      "no channel " + std::to_string(target.index) + ": the material has " + std::to_string(f.channels()),
      "--target", "channels count from 0");
}

}  // namespace

void add_build_choices(CLI::App& command, BuildChoices& choices) {
  const auto option = [&](const char* name, auto& value, const char* type, const char* words) {
    return command.add_option(name, value, words)
        ->each([&choices](const std::string&) { choices.given = true; })
        ->capture_default_str()
        ->type_name(type)
        ->group("Options of building, for a material");
  };
  option("--trials", choices.trials, "N", "Expected trials of exact mode, for every wo; 1.02 to 16")
      ->check(CLI::Range(1.02, 16.).description(""));
  option("--variance", choices.variance, "V",
         "Relative variance of the weight in one-shot mode; 0.0001 to 10")
      ->check(CLI::Range(1e-4, 10.).description(""));
  option("--target", choices.target, "WORD",
         "What is sampled, of the channels: norm, luminance, maximum, channel:K");
  option("--domain", choices.domain, "WORD",
         "Map of the square: auto, projected_disk, equal_area, half_vector,\n"
         "back_vector, mirror_vector, normal_vector, stretched:A");
}

BuildOptions build_options(const Context& context, const BuildChoices& choices) {
  BuildOptions options;
  options.expected_trials = choices.trials;
  options.one_shot_variance = choices.variance;
  options.target = parse_target(choices.target);
  options.domain = parse_domain(choices.domain);
  options.seed = context.seed;
  return options;
}

namespace {

// Whether it is the file of a sampler, to which options of building do not apply.
bool is_built(const std::string& text, const FilePlaces& places, const BuildChoices& choices) {
  if (!names_sampler_file(text, places)) return false;
  if (choices.given) {
    throw Error("options of building do not apply to a sampler that is built", text,
                "leave them out, or name the material");
  }
  return true;
}

}  // namespace

OpenedFamily open_family(const Context& context, const std::string& text, const BuildChoices& choices) {
  const FilePlaces places = context.places();
  if (is_built(text, places, choices)) return reflectree::open_family(text, places);
  OpenedFamily family =
      reflectree::open_family(text, places, build_options(context, choices), context.host("building"));
  context.detail(fmt::format("built in {:.2f} s, {} evaluations", *family.build_seconds,
                             family.data.report.evaluations));
  return family;
}

void add_member_choice(CLI::App& command, std::string& at) {
  command
      .add_option("--at", at,
                  "Of a family, such as ggx:alpha=0.02..1: the member that is meant, as alpha=0.3")
      ->type_name("NAME=N,...");
}

OpenedSampler open_sampler(const Context& context, const std::string& text, const BuildChoices& choices,
                           const std::string& at) {
  const FilePlaces places = context.places();
  if (names_family(text, places)) {
    if (at.empty()) throw Error("is a family", text, "say which member is meant, by --at NAME=NUMBER,...");
    const OpenedFamily family = open_family(context, text, choices);
    return open_member(family, parse_parameters(at, family.family.ranges()));
  }
  if (!at.empty()) throw Error("is no family", text, "leave out --at, or give a parameter a range");
  if (is_built(text, places, choices)) return open_sampler_file(text, places);
  const BuildOptions options = build_options(context, choices);
  AnyBrdf f = open_brdf(text, places);
  check_target(options.target, f);
  OpenedSampler subject = build_named_sampler(text, std::move(f), places, options, context.host("building"));
  context.detail(fmt::format("built in {:.2f} s, {} evaluations", *subject.build_seconds,
                             subject.data.report.evaluations));
  return subject;
}

namespace {

template <class F>
void prove(const Context& context, SamplerData& data, const F& f, const CertifyOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const Certification c = certify(data, f, options, context.host("certifying"));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  context.say(fmt::format("proved {} of {} leaves, {} of {} slabs, in {:.2f} s; {} bounds were raised",
                          c.proved_leaves, c.leaves, c.certified_slabs, c.slabs, took.count(),
                          c.raised_leaves));
  context.detail(fmt::format("looked at {} boxes", c.boxes));
}

}  // namespace

OpenedSampler certified(const Context& context, OpenedSampler subject, const CertifyOptions& options) {
  prove(context, subject.data, subject.f, options);
  subject.packed = std::make_shared<const PackedSampler>(pack(subject.data));
  subject.sampler = {ExactSampler<AnyBrdf>(subject.f, subject.packed),
                     OneShotSampler<AnyBrdf>(subject.f, subject.packed)};
  return subject;
}
OpenedFamily certified(const Context& context, OpenedFamily subject, const CertifyOptions& options) {
  prove(context, subject.data, subject.family, options);
  const std::optional<double> seconds = subject.build_seconds;
  const std::string text = subject.text, file = subject.sampler_file;
  subject = reflectree::open_family(subject.family, std::move(subject.data), subject.places);
  subject.text = text, subject.sampler_file = file, subject.build_seconds = seconds;
  return subject;
}

void prove_albedo_of(const Context& context, OpenedSampler& subject, double relative_error) {
  const auto start = std::chrono::steady_clock::now();
  const AlbedoProof proof =
      prove_albedo(subject.data, subject.f, {.relative_error = relative_error}, context.host("proving"));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  context.say(proof.relative_error < 1 ? fmt::format("proved the albedo to within {:.3g}, in {:.2f} s",
                                                     proof.relative_error, took.count())
                                       : "could prove nothing about the albedo within the boxes");
  context.detail(fmt::format("looked at {} boxes", proof.boxes));
}

}  // namespace reflectree::cli
