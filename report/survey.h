#pragma once

#include <string>
#include <vector>

#include "core/formats/survey_files.h"
#include "report/options.h"

namespace mocurate {

/// Motions of one origin: a method, or recordings.
struct SurveySource {
  struct Motion {
    std::string clip;   ///< id
    std::string label;  ///< or empty: not shown
  };
  std::string name;
  std::vector<Motion> motions;
};

/// Draws questions about labels that every source has; labels are in random order, round by round. A ranking shows one
/// motion of each source. Real or fake shows `options.clips` motions a page: half of all are real, a third to two
/// thirds of a page, and the others are spread evenly over the generated sources. No motion is shown twice. Every draw
/// is keyed by (seed, purpose, item). Fingerprints are empty. Errors: kUsage for fewer than two sources, more than nine
/// in a ranking, equal names, an unknown `real` or label, too few motions; kInconsistent without a common label.
Expected<SurveyKey> DrawSurvey(const SurveyOptions& options, const std::vector<SurveySource>& sources);

/// An SVG file of a tally (eval/survey/survey_tally.h): for each source a bar of the shares of its ranks, or of the
/// share judged real with Wilson's interval as a whisker; without answers a note.
std::string TallyToSvg(const nlohmann::ordered_json& tally, const std::string& corner = "");

}  // namespace mocurate
