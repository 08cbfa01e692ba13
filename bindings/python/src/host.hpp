// SPDX-License-Identifier: Apache-2.0
// What Python lends to long work: threads, a callable that is told of progress, and Ctrl-C.
#pragma once

#include <nanobind/nanobind.h>

#include "reflectree/host.hpp"

namespace reflectree::python {

// threads: 0 for as many as there are cores. progress: None, or called as progress(fraction, stage), at most
// twenty times per second, by the calling thread alone; what it raises ends the work, as Ctrl-C does. Call
// it, and the work, with or without the GIL; copies share their threads.
Host make_host(unsigned threads, nanobind::object progress);

}  // namespace reflectree::python
