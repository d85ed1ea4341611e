// key.json and answers_PARTICIPANT.json, checked strictly: edited files must not change a count.

#include "core/formats/survey_files.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/json_text.h"
#include "core/base/sha256.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestParticipant = 40;
constexpr const char* kSaveAgain = "save the file again from the page, or skip it with --skip-bad";
constexpr const char* kMakeAgain = "use the key.json that `mocurate survey make` wrote beside the page";

std::string DumpedJson(const Json& value) { return value.dump(-1, ' ', true, Json::error_handler_t::replace); }

/// A value in a message: at most 60 characters of its JSON.
std::string ShownValue(const Json& value) {
  const std::string text = DumpedJson(value);
  return text.size() <= 60 ? text : text.substr(0, 57) + "...";
}

/// An object of JSON. A repeated key in an object is also an error, because only one of its values would count.
Expected<Json> ParseObject(std::string_view bytes, const std::string& name, const char* hint) {
  Expected<Json> json = ParseJson(bytes, name);
  if (!json) return Forward(json);
  if (const auto twice = RepeatedKey(bytes)) {
    return Fail(ErrorCode::kMalformed, "the key " + ShownValue(*twice) + " is repeated", name, hint);
  }
  if (!json->is_object()) return Fail(ErrorCode::kMalformed, "the file is not a JSON object", name + ": /", hint);
  return json;
}

/// Whether an object has these keys and no others.
Status CheckKeys(const Json& object, const std::vector<std::string>& keys, const std::string& where) {
  if (!object.is_object()) {
    return Fail(ErrorCode::kMalformed, "expected is an object, not " + ShownValue(object), where, kSaveAgain);
  }
  for (const auto& item : object.items()) {
    if (std::find(keys.begin(), keys.end(), item.key()) != keys.end()) continue;
    return Fail(ErrorCode::kMalformed, "unknown key " + ShownValue(item.key()), where, kSaveAgain);
  }
  for (const std::string& key : keys) {
    if (object.contains(key)) continue;
    return Fail(ErrorCode::kMalformed, "the key \"" + key + "\" is missing", where, kSaveAgain);
  }
  return {};
}

bool IsParticipant(const std::string& text) {
  const auto allowed = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || c == '-';
  };
  return !text.empty() && text.size() <= kLongestParticipant && std::all_of(text.begin(), text.end(), allowed);
}

/// Throws Json::exception for a value that is missing or has another type.
SurveyKey KeyOfJson(const Json& json) {
  SurveyKey key;
  key.kind = json.at("kind") == Name(SurveyKind::kRanking) ? SurveyKind::kRanking : SurveyKind::kRealOrFake;
  if (key.kind == SurveyKind::kRealOrFake) key.real = json.at("real").get<std::string>();
  key.seed = json.at("seed").get<std::int64_t>();
  key.sources = json.at("sources").get<std::vector<std::string>>();
  key.labels = json.at("labels").get<std::vector<std::string>>();
  for (const Json& asked : json.at("questions")) {
    SurveyQuestion question{asked.at("question").get<std::string>(), asked.at("label").get<std::string>(), {}};
    for (const Json& shown : asked.at("shown")) {
      question.shown.push_back({shown.at("source").get<std::string>(), shown.at("clip").get<std::string>(),
                                shown.at("motion").get<std::string>()});
    }
    key.questions.push_back(std::move(question));
  }
  return key;
}

Json ContentOfKey(const SurveyKey& key) {
  Json json = {{"kind", Name(key.kind)},
               {"seed", key.seed},
               {"sources", key.sources},
               {"labels", key.labels},
               {"questions", Json::array()}};
  if (key.kind == SurveyKind::kRealOrFake) json["real"] = key.real;
  for (const SurveyQuestion& question : key.questions) {
    Json asked = {{"question", question.id}, {"label", question.label}, {"shown", Json::array()}};
    for (const ShownMotion& shown : question.shown) {
      asked["shown"].push_back({{"source", shown.source}, {"clip", shown.clip}, {"motion", shown.fingerprint}});
    }
    json["questions"].push_back(std::move(asked));
  }
  return json;
}

/// SurveyAnswers::values of one question with `count` motions.
Expected<std::vector<int>> ValuesOf(const Json& answer, SurveyKind kind, std::size_t count, const std::string& where) {
  const bool ranking = kind == SurveyKind::kRanking;
  const auto number = static_cast<int>(count);
  const std::string expected = ranking ? "the ranks 1 to " + std::to_string(count) + ", each once"
                                       : std::to_string(count) + " of \"real\" and \"generated\"";
  const auto refused = [&] {
    return Fail(ErrorCode::kMalformed, "answer " + ShownValue(answer) + ", expected is a list of " + expected, where,
                kSaveAgain);
  };
  if (!answer.is_array() || answer.size() != count) return refused();
  std::vector<int> values;
  for (const Json& one : answer) {
    const bool known = ranking ? one.is_number_integer() && one >= 1 && one <= number &&
                                     std::find(values.begin(), values.end(), one.get<int>()) == values.end()
                               : one == "real" || one == "generated";
    if (!known) return refused();
    values.push_back(ranking ? one.get<int>() : one == "real" ? 1 : 2);
  }
  return values;
}

}  // namespace

std::string_view Name(SurveyKind kind) { return kind == SurveyKind::kRanking ? "ranking" : "real_or_fake"; }

std::string SurveyId(const SurveyKey& key) { return Sha256Hex(DumpedJson(ContentOfKey(key))).substr(0, 16); }

Json KeyToJson(const SurveyKey& key) {
  Json json = ContentOfKey(key);
  json["survey"] = SurveyId(key);
  return json;
}

Expected<SurveyKey> ReadSurveyKey(std::string_view bytes, const std::string& name) {
  const Expected<Json> json = ParseObject(bytes, name, kMakeAgain);
  if (!json) return Forward(json);
  if (json->contains("participant")) {
    return Fail(ErrorCode::kMalformed, "the file has answers, not the key of a survey", name, kMakeAgain);
  }
  const Json kind = json->value("kind", Json());
  if (kind != Name(SurveyKind::kRanking) && kind != Name(SurveyKind::kRealOrFake)) {
    return Fail(ErrorCode::kMalformed,
                "kind " + ShownValue(kind) +
                    "; known are \"ranking\", which replaced \"preference\", and "
                    "\"real_or_fake\"",
                name + ": /kind", kMakeAgain);
  }
  Expected<SurveyKey> key = GuardJson(name, [&] { return KeyOfJson(*json); });
  if (!key) return key;
  const Json written = KeyToJson(*key);
  if (const auto id = json->find("survey"); id == json->end() || *id != written.at("survey")) {
    return Fail(ErrorCode::kInconsistent,
                "its survey id is " + (id == json->end() ? "missing" : ShownValue(*id)) +
                    ", but that of its content is " + ShownValue(written.at("survey")) + ": it was edited",
                name, kMakeAgain);
  }
  if (written != *json)
    return Fail(ErrorCode::kMalformed, "the file has more than a key of a survey", name, kMakeAgain);
  return key;
}

Expected<SurveyAnswers> ReadSurveyAnswers(std::string_view bytes, const std::string& name, const SurveyKey& key) {
  const Expected<Json> json = ParseObject(bytes, name, kSaveAgain);
  if (!json) return Forward(json);
  if (Status keys = CheckKeys(*json, {"survey", "participant", "answers", "missing"}, name + ": /"); !keys) {
    return Forward(keys);
  }
  if (const std::string id = SurveyId(key); json->at("survey") != id) {
    return Fail(ErrorCode::kInconsistent,
                "answers of survey " + ShownValue(json->at("survey")) + ", the key is of survey \"" + id + "\"",
                name + ": /survey", "use the key.json made with the page, or skip the file with --skip-bad");
  }
  SurveyAnswers answers;
  const Json& participant = json->at("participant");
  if (!participant.is_string() || !IsParticipant(participant.get<std::string>())) {
    return Fail(ErrorCode::kMalformed,
                "participant " + ShownValue(participant) + ", allowed are 1 to 40 of A-Z a-z 0-9 _ -",
                name + ": /participant", kSaveAgain);
  }
  answers.participant = participant.get<std::string>();
  if (!json->at("answers").is_array()) {
    return Fail(ErrorCode::kMalformed, "expected is a list, not " + ShownValue(json->at("answers")),
                name + ": /answers", kSaveAgain);
  }
  std::map<std::string, std::size_t> place_of;
  for (std::size_t i = 0; i < key.questions.size(); ++i) place_of[key.questions[i].id] = i;
  answers.values.resize(key.questions.size());
  for (std::size_t i = 0; i < json->at("answers").size(); ++i) {
    const Json& given = json->at("answers")[i];
    const std::string where = name + ": /answers/" + std::to_string(i);
    if (Status keys = CheckKeys(given, {"question", "answer"}, where); !keys) return Forward(keys);
    const Json& question = given.at("question");
    const auto place = question.is_string() ? place_of.find(question.get<std::string>()) : place_of.end();
    if (place == place_of.end()) {
      return Fail(ErrorCode::kMalformed,
                  "unknown question " + ShownValue(question) + ", the survey has " +
                      (key.questions.empty() ? "none" : key.questions.front().id + " to " + key.questions.back().id),
                  where + "/question", kSaveAgain);
    }
    auto values = ValuesOf(given.at("answer"), key.kind, key.questions[place->second].shown.size(), where + "/answer");
    if (!values) return Forward(values);
    if (!answers.values[place->second].empty()) {
      return Fail(ErrorCode::kMalformed, "question " + ShownValue(question) + " is answered twice", where + "/question",
                  kSaveAgain);
    }
    answers.values[place->second] = std::move(*values);
  }
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < key.questions.size(); ++i) {
    if (answers.values[i].empty()) missing.push_back(key.questions[i].id);
  }
  if (!missing.empty()) {
    std::string list;
    for (std::size_t i = 0; i < std::min<std::size_t>(missing.size(), 8); ++i) list += (i > 0 ? ", " : "") + missing[i];
    return Fail(ErrorCode::kInconsistent,
                std::to_string(key.questions.size() - missing.size()) + " of " +
                    Counted(static_cast<long long>(key.questions.size()), "question") +
                    " are answered; missing: " + list + (missing.size() > 8 ? ", ..." : ""),
                name + ": /answers", "answer them on the page and save again, or skip the file with --skip-bad");
  }
  return answers;
}

}  // namespace mocurate
