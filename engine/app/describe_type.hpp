// One component type, told from its descriptor.
#pragma once

#include <string>

#include "plugin/registry.hpp"

namespace bramah {

std::string type_text(const Registry& registry, const bramah_type& type);
std::string type_document(const Registry& registry, const bramah_type& type);

}  // namespace bramah
