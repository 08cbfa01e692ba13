// SPDX-License-Identifier: Apache-2.0
// Each adds a subcommand with its help; parsing it sets `run`, which main() calls afterwards.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "context.hpp"

namespace reflectree::cli {

using Run = std::function<int()>;

void add_list(CLI::App& app, Context& context, Run& run);
void add_build(CLI::App& app, Context& context, Run& run);
void add_certify(CLI::App& app, Context& context, Run& run);
void add_info(CLI::App& app, Context& context, Run& run);
void add_eval(CLI::App& app, Context& context, Run& run);
void add_sample(CLI::App& app, Context& context, Run& run);
void add_verify(CLI::App& app, Context& context, Run& run);
void add_doctor(CLI::App& app, Context& context, Run& run);
void add_draw(CLI::App& app, Context& context, Run& run);
void add_bake(CLI::App& app, Context& context, Run& run);
void add_export(CLI::App& app, Context& context, Run& run);
void add_compare(CLI::App& app, Context& context, Run& run);
void add_render(CLI::App& app, Context& context, Run& run);
void add_image_compare(CLI::App& app, Context& context, Run& run);
void add_demo(CLI::App& app, Context& context, Run& run);

}  // namespace reflectree::cli
