// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/square/domain.hpp"

namespace reflectree {

const char* name_of(DomainKind kind) {
  switch (kind) {
    case DomainKind::projected_disk:
      return "projected_disk";
    case DomainKind::equal_area:
      return "equal_area";
    case DomainKind::half_vector:
      return "half_vector";
    case DomainKind::back_vector:
      return "back_vector";
    case DomainKind::stretched:
      return "stretched";
    case DomainKind::mirror_vector:
      return "mirror_vector";
    case DomainKind::normal_vector:
      return "normal_vector";
    case DomainKind::slope_star:
      return "slope_star";
    case DomainKind::scaled_star:
      return "scaled_star";
  }
  return "unknown";
}

}  // namespace reflectree
