// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

// CRC-32 of IEEE 802.3 (as in zip and png): detects every burst of damage up to 32 bits.
std::uint32_t crc32(ByteView bytes);

}  // namespace reflectree
