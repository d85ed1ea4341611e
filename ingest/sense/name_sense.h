#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/formats/bandai_label.h"

namespace mocurate {

/// Why a name of the form S001C001P001R001A001 is none of NTU RGB+D 60 and 120: setups 1 to 32, cameras 1 to 3,
/// performers 1 to 106, repetitions 1 and 2, actions 1 to 60 up to setup 17 and 61 to 120 from 18 on (Liu et al. 2019,
/// and the authors' list of files). Nothing of other names.
std::optional<std::string> DoubtNtuName(const std::filesystem::path& path);

/// Whether an action of NTU RGB+D 60 and 120 is one of two people: 50 to 60 and 106 to 120 (Liu et al. 2019, table 2).
bool IsNtuActionOfTwo(long long action);

/// What `label`, read from the file `path`, says else than the name of that file, "dataset-1_bow_old_001.json", by
/// content_label.txt and style_label.txt beside it; nothing where these are not there, or the name has another form.
std::optional<std::string> DoubtBandaiLabel(const std::filesystem::path& path, const BandaiLabel& label);

/// Of a motion, whose name and the label file beside it are asked.
std::optional<std::string> DoubtName(const std::filesystem::path& motion);

}  // namespace mocurate
