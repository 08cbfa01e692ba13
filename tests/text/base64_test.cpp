// SPDX-License-Identifier: Apache-2.0
#include "reflectree/text/base64.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace reflectree {
namespace {

TEST(Base64, Rfc4648Vectors) {
  const auto encoded = [](const std::string& s) {
    return base64(std::vector<std::uint8_t>(s.begin(), s.end()));
  };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace reflectree
