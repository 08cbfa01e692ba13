// SPDX-License-Identifier: Apache-2.0
// Ctrl-C is a flag that long work polls; a second Ctrl-C ends the program at once.
#pragma once

namespace reflectree::cli {

void watch_for_interrupt();
bool interrupted();

}  // namespace reflectree::cli
