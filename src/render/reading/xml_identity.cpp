// SPDX-License-Identifier: Apache-2.0
// What a scene is, as a number: its elements without comments, space and the number of samples, names
// replaced by what they stand for; the samplers of its materials; the contents of the files that it names.
#include <algorithm>

#include "fnv.hpp"
#include "reflectree/formats/file.hpp"
#include "xml_reader.hpp"

namespace reflectree::render {

std::uint64_t XmlReader::hash(Node n, std::uint64_t h) const {
  const std::string_view tag = n.name();
  if (n.type() != pugi::node_element || tag == "default" ||
      n.attribute("name").value() == std::string_view("sample_count"))
    return h;
  h = fnv(tag, h);
  for (const pugi::xml_attribute a : n.attributes()) {
    h = fnv(std::string_view(a.value()), fnv(std::string_view(a.name()), h));
  }
  for (const Node c : n.children()) h = hash(c, h);
  return fnv(std::string_view("/"), h);
}

std::uint64_t XmlReader::fingerprint() const {
  std::uint64_t h = fnv(options_.adjoint, fnv(options_.sampler, hash(root_, fnv_start)));
  std::vector<std::string> files = files_;
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  for (const std::string& file : files) h = fnv(read_file(file, std::uint64_t(1) << 34U), h);
  return h;
}

}  // namespace reflectree::render
