// SPDX-License-Identifier: Apache-2.0
// certify: proves the bounds of a saved sampler.
#include <filesystem>

#include "commands.hpp"
#include "info.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "subject.hpp"

namespace reflectree::cli {

void add_certify(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand("certify", "Prove the bounds of a saved sampler, and save it again");
  struct Options {
    std::string sampler, output;
    CertifyOptions certify;
    double albedo = 0;
  };
  auto o = std::make_shared<Options>();
  command->add_option("SAMPLER", o->sampler, "A sampler file that 'reflectree build' saved")
      ->type_name("")
      ->required();
  command->add_option("-o,--output", o->output, "The sampler file to write; without it, SAMPLER itself")
      ->type_name("FILE");
  command
      ->add_option("--tolerance", o->certify.tolerance,
                   "How far a bound may be above the best value seen in its leaf; relative, 0.0001 to 1")
      ->check(CLI::Range(1e-4, 1.).description(""))
      ->capture_default_str()
      ->type_name("X");
  command
      ->add_option(
          "--boxes", o->certify.boxes_per_leaf,
          "Boxes that the proof of a leaf may look at; what is proved by then is kept, up to twice the "
          "best value seen")
      ->check(CLI::Range(std::uint64_t(1), std::uint64_t(1) << 40U).description(""))
      ->capture_default_str()
      ->type_name("N");
  command
      ->add_option(
          "--albedo", o->albedo,
          "Prove the stored albedo, too, to within this relative error: 0.02 takes seconds to minutes, "
          "half of it three times as long")
      ->check(CLI::Range(1e-4, 0.5).description(""))
      ->type_name("X");
  command->footer(
      "Example:\n"
      "  reflectree certify gold.rfl -o gold-certified.rfl\n"
      "Bounds rise where the proof needs it. Exit code 1: some slabs, or the albedo, could not be proved "
      "within "
      "the boxes;\n"
      "slabs keep their estimated bounds, and the file is written all the same, with what was proved.");
  command->callback([&context, &run, o] {
    run = [&context, o] {
      if (!names_sampler_file(o->sampler, context.places())) {
        throw Error("is no sampler file", o->sampler,
                    "build one: reflectree build MATERIAL -o FILE --certify");
      }
      if (!o->output.empty()) check_output(o->output);
      o->certify.loosest = std::max(o->certify.loosest, o->certify.tolerance);
      const auto save = [&](auto subject) {
        const std::string path = o->output.empty() ? subject.sampler_file : o->output;
        save_sampler(path, subject.data);
        subject.file_size = std::filesystem::file_size(path);
        show_info(context, "certify", subject);
        context.say("saved " + path);
        const bool all =
            std::all_of(subject.data.exact.begin(), subject.data.exact.end(),
                        [](const MajorantTree& t) { return t.status == BoundStatus::certified; });
        const bool albedo = o->albedo == 0 || (subject.data.albedo.proved_error > 0 &&
                                               subject.data.albedo.proved_error <= float(o->albedo));
        return int(all && albedo ? exit_success : exit_check_failed);
      };
      const FilePlaces places = context.places();
      if (names_family(o->sampler, places)) {
        if (o->albedo > 0) {
          throw Error("the albedo of a family has no proof", o->sampler,
                      "leave --albedo out; 'info' tells the error that was measured");
        }
        return save(certified(context, reflectree::open_family(o->sampler, places), o->certify));
      }
      OpenedSampler subject = certified(context, open_sampler_file(o->sampler, places), o->certify);
      if (o->albedo > 0) prove_albedo_of(context, subject, o->albedo);
      return save(std::move(subject));
    };
  });
}

}  // namespace reflectree::cli
