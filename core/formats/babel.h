#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// A label of BABEL. Times are those of frame labels, seconds; labels of a sequence have none. Labels are neither
/// sorted nor disjoint, and may run past the duration.
struct BabelLabel {
  std::optional<std::string> raw_label;
  std::optional<std::string> proc_label;
  std::optional<std::vector<std::string>> act_cat;  ///< null in the test set; may be empty
  std::string seg_id;                               ///< empty where the file has none
  std::optional<double> start_t;
  std::optional<double> end_t;
};

/// One annotator's labels of a sequence.
struct BabelAnnotation {
  std::string babel_lid;  ///< empty where the file has none, as is anntr_id
  std::string anntr_id;
  std::optional<bool> mul_act;
  std::vector<BabelLabel> labels;
};

struct BabelSequence {
  std::string key;  ///< in the top object: babel_sid as text
  std::int64_t babel_sid = 0;
  std::string url;                          ///< of the video; empty where the file has none
  std::string feat_p;                       ///< path of the AMASS file, with the dataset in front; may hold blanks
  double dur = 0.0;                         ///< seconds, rounded to 0.01
  bool extra = false;                       ///< from an extra_*.json: `seq_anns`, `frame_anns`
  std::vector<BabelAnnotation> seq_anns;    ///< dense: at most one
  std::vector<BabelAnnotation> frame_anns;  ///< none: the action spans the sequence
};

/// A label whose times cannot be: start missing or negative, end not after start, or more than 0.1 s after
/// the end of the sequence.
struct BabelProblem {
  std::string where;  ///< "7692/frame_ann/labels/2"
  std::string what;
};

/// train.json, val.json, test.json and the extra files, in the file's order. Unknown keys are ignored; url, babel_lid,
/// anntr_id and seg_id, which other programs than BABEL's cannot know, may be missing or null. Errors kMalformed name
/// the path of the field. Impossible times are not errors, see FindBabelProblems.
Expected<std::vector<BabelSequence>> ParseBabel(std::string_view bytes, const std::string& name);
std::vector<BabelProblem> FindBabelProblems(const BabelSequence& sequence);

/// Whether a category is one of the 150 that most segments have, or "transition". BABEL has some hundred more, which
/// few segments have.
bool IsFrequentBabelCategory(std::string_view category);
std::vector<std::string> FrequentBabelCategories();

/// Text in the layout of the dense or the extra files. Empty identifiers are omitted.
std::string EncodeBabel(const std::vector<BabelSequence>& sequences);

}  // namespace mocurate
