// SPDX-License-Identifier: Apache-2.0
// What is doubtful in a file, format by format; rows of the table of formats name these.
#pragma once

#include "reflectree/brdf/tables/half_angle_table.hpp"
#include "reflectree/formats/measured_facts.hpp"

namespace reflectree {

// The look-up that the member of a MERL file names. Throws Error for others.
TableLookup merl_lookup(const std::string& path, const std::string& member);

// Whether the member of an RGL file is the RGB of its spectra. Throws Error for what is none.
bool rgl_as_rgb(ByteView bytes, const std::string& path, const std::string& member);

MeasuredFacts rgl_facts(ByteView bytes, const std::string& path, const std::string& member);
MeasuredFacts merl_facts(ByteView bytes, const std::string& path, const std::string& member);
MeasuredFacts table_facts(ByteView bytes, const std::string& path, const std::string& member);

}  // namespace reflectree
