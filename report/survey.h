#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "report/options.h"

namespace mocurate {

/// Motions of one origin: a method, or recordings.
struct SurveySource {
  struct Motion {
    std::string clip;   ///< id
    std::string label;  ///< or empty: is not shown
  };
  std::string name;
  std::vector<Motion> motions;
};

/// A motion at a place of a question.
struct ShownMotion {
  std::string source;
  std::string clip;         ///< id
  std::string fingerprint;  ///< of the motion as it is shown (core/motion/fingerprint.h)
};

struct SurveyQuestion {
  std::string id;  ///< "q001", in the order of the page
  std::string label;
  std::vector<ShownMotion> shown;  ///< preference: left, right; real_or_fake: one
};

/// What stands where on the page of a survey: key.json. The page itself names no source.
struct SurveyKey {
  SurveyKind kind = SurveyKind::kPreference;
  std::string real;  ///< the source whose motions are recordings; empty: of a preference
  std::int64_t seed = 1;
  std::vector<std::string> sources;
  std::vector<std::string> labels;  ///< that are asked about
  std::vector<SurveyQuestion> questions;
};

/// Answers that a question has: "left", "right" or "real", "generated".
std::array<std::string, 2> AnswersOf(SurveyKind kind);
std::string_view Name(SurveyKind kind);

/// Draws questions about labels that every source has motions of. A preference compares each pair of sources, real or
/// fake shows each source: rounds of one question for each of these and each label, in an order of their own, until
/// there are `options.questions`, or all but at most 40 without a number. A motion is shown once at most, in a
/// preference once for each pair. Of two questions about one pair each source stands left once. Every draw is keyed by
/// (seed, purpose, item). Fingerprints are empty. Errors: kUsage for other than two or more sources of different names,
/// a `real` or label that is not there, more questions than motions; kInconsistent without a common label.
Expected<SurveyKey> DrawSurvey(const SurveyOptions& options, const std::vector<SurveySource>& sources);

/// Sixteen hexadecimal digits of the SHA-256 of the key: which survey an answer belongs to.
std::string SurveyId(const SurveyKey& key);

nlohmann::json KeyToJson(const SurveyKey& key);
/// Error kMalformed for what KeyToJson does not write, kInconsistent when the id is not that of the content. `name`
/// stands in messages.
Expected<SurveyKey> ReadSurveyKey(std::string_view bytes, const std::string& name);

/// One person's answers: a file that the page saves, answers_PARTICIPANT.json.
struct SurveyAnswers {
  std::string participant;  ///< 1 to 40 of A-Z a-z 0-9 _ -
  std::vector<int> choice;  ///< of each question of the key: place in AnswersOf
};

/// Errors kMalformed "name: /answers/3": no JSON, a key, question or answer that there is not, a question twice;
/// kInconsistent: of another survey, or a question without an answer.
Expected<SurveyAnswers> ReadSurveyAnswers(std::string_view bytes, const std::string& name, const SurveyKey& key);

}  // namespace mocurate
