#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

enum class SurveyKind { kRanking, kRealOrFake };
std::string_view Name(SurveyKind kind);

/// Row of all sources of real or fake but the recordings, where there are two or more.
inline constexpr const char* kAllGenerated = "all generated";

/// A motion in a question.
struct ShownMotion {
  std::string source;
  std::string clip;         ///< id
  std::string fingerprint;  ///< of the shown motion (core/motion/motion.h)
};

/// One page: motions of one label.
struct SurveyQuestion {
  std::string id;  ///< "q001", in the order of the page
  std::string label;
  std::vector<ShownMotion> shown;  ///< in the order of the page; ranking: one of each source
};

/// The sources of the motions on a survey page: key.json. The page itself names no source.
struct SurveyKey {
  SurveyKind kind = SurveyKind::kRanking;
  std::string real;  ///< the source of recordings; empty for a ranking
  std::int64_t seed = 1;
  std::vector<std::string> sources;
  std::vector<std::string> labels;  ///< of the questions
  std::vector<SurveyQuestion> questions;
};

/// Survey id of the answers: sixteen hexadecimal digits of the key's SHA-256.
std::string SurveyId(const SurveyKey& key);

nlohmann::json KeyToJson(const SurveyKey& key);
/// Error kMalformed for anything that KeyToJson does not write, kInconsistent when the id does not match the content.
/// `name` is for messages.
Expected<SurveyKey> ReadSurveyKey(std::string_view bytes, const std::string& name);

/// One person's answers: a file that the page saves, answers_PARTICIPANT.json.
struct SurveyAnswers {
  std::string participant;  ///< 1 to 40 of A-Z a-z 0-9 _ -
  /// Of each question, of each shown motion. Ranking: its rank, 1 is the best; real_or_fake: 1 real, 2 generated.
  std::vector<std::vector<int>> values;
};

/// Errors kMalformed "name: /answers/3": not JSON, an unknown key, question or answer, ranks that are no permutation, a
/// repeated question; kInconsistent: of another survey, or a question without an answer.
Expected<SurveyAnswers> ReadSurveyAnswers(std::string_view bytes, const std::string& name, const SurveyKey& key);

}  // namespace mocurate
