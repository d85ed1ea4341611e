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
    std::string label;  ///< or empty: not shown
  };
  std::string name;
  std::vector<Motion> motions;
};

/// A motion in a question.
struct ShownMotion {
  std::string source;
  std::string clip;         ///< id
  std::string fingerprint;  ///< of the shown motion (core/motion/motion.h)
};

struct SurveyQuestion {
  std::string id;  ///< "q001", in the order of the page
  std::string label;
  std::vector<ShownMotion> shown;  ///< preference: left, right; real_or_fake: one
};

/// The sources of the motions on a survey page: key.json. The page itself names no source.
struct SurveyKey {
  SurveyKind kind = SurveyKind::kPreference;
  std::string real;  ///< the source of recordings; empty for a preference
  std::int64_t seed = 1;
  std::vector<std::string> sources;
  std::vector<std::string> labels;  ///< of the questions
  std::vector<SurveyQuestion> questions;
};

/// Possible answers: "left", "right" or "real", "generated".
std::array<std::string, 2> AnswersOf(SurveyKind kind);
std::string_view Name(SurveyKind kind);

/// Draws questions about labels that every source has. A preference compares each pair of sources, real or fake shows
/// each source. A round has one question for each of these and each label, in random order; rounds repeat until there
/// are `options.questions`, or as many as possible up to 40 without a number. A motion is shown at most once, in a
/// preference at most once per pair. Of two questions about one pair each source is on the left once. Every draw is
/// keyed by (seed, purpose, item). Fingerprints are empty. Errors: kUsage for fewer than two sources or equal names, an
/// unknown `real` or label, more questions than motions; kInconsistent without a common label.
Expected<SurveyKey> DrawSurvey(const SurveyOptions& options, const std::vector<SurveySource>& sources);

/// Survey id of the answers: sixteen hexadecimal digits of the key's SHA-256.
std::string SurveyId(const SurveyKey& key);

nlohmann::json KeyToJson(const SurveyKey& key);
/// Error kMalformed for anything that KeyToJson does not write, kInconsistent when the id does not match the content.
/// `name` is for messages.
Expected<SurveyKey> ReadSurveyKey(std::string_view bytes, const std::string& name);

/// One person's answers: a file that the page saves, answers_PARTICIPANT.json.
struct SurveyAnswers {
  std::string participant;  ///< 1 to 40 of A-Z a-z 0-9 _ -
  std::vector<int> choice;  ///< of each question of the key: index in AnswersOf
};

/// Errors kMalformed "name: /answers/3": not JSON, an unknown key, question or answer, a repeated question;
/// kInconsistent: of another survey, or a question without an answer.
Expected<SurveyAnswers> ReadSurveyAnswers(std::string_view bytes, const std::string& name, const SurveyKey& key);

}  // namespace mocurate
