#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "core/body/skinned_body.h"

namespace mocurate {

/// A body template of the layout of body_cc0.h5: faces, parents, joint_names, weights_idx4, weights_val4, v_template,
/// J_template, shapedirs, J_shapedirs, shape_names, variants/NAME/{vertices_tpose, joints_tpose}. Errors of Hdf5Reader;
/// kMalformed for a wrong shape and kInconsistent for broken rules, with "file.h5:/field".
Expected<BodyTemplate> ReadBodyTemplate(const std::filesystem::path& file);

}  // namespace mocurate
