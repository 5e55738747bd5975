// What make_scene would say of one body, or of one shape that stands still, so that it is said where that is described.
#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

// Error(kArgument) or Error(kRange). Of copies: make_scene also makes quaternions exact.
void validate_body(BodyDef body, int32_t num_materials);
void validate_static(ShapeDef shape, int32_t num_materials);

}  // namespace rdm
