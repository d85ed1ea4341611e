#include "core/formats/babel.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

using nlohmann::ordered_json;

constexpr double kLongestOver_s = 0.1;  // that a label ends after its sequence: durations are rounded

/// The 150 categories of most segments (action_label_2_idx.json of BABEL's release), and transitions, in order.
constexpr std::string_view kCategories =
    "a pose, action with ball, adjust, arm movements, backwards movement, balance, bend, bow, bump, cartwheel, "
    "catch, check, circular movement, clap, clean something, communicate (vocalise), crawl, crossing limbs, "
    "crouch, dance, draw, dribble, drink, duck, eat, evade, exercise/training, flail arms, flap, flip, "
    "foot movements, forward movement, gesture, get injured, give something, golf, grab body part, grab person, "
    "grasp object, greet, hand movements, hang, head movements, hit, hop, interact with rope, "
    "interact with/use object, jog, jump, jump rope, jumping jacks, kick, knee movement, kneel, knock, lean, leap, "
    "leg movements, lift something, limp, look, lowering body part, lunge, march, martial art, mime, "
    "misc. abstract action, mix, move back to original position, move misc. body part, move something, "
    "move up/down incline, open something, perform, place something, play catch, play instrument, play sport, "
    "point, poses, pray, press something, protect, punch, raising body part, relax, release, rocking movement, "
    "rolling movement, rub, run, salute, scratch, shake, shivering, shoulder movements, shrug, shuffle, "
    "side to side movement, sideways movement, sit, skip, slide, sneak, spin, sports move, spread, squat, stagger, "
    "stances, stand, stand up, step, stop, strafe, stretch, stroke, stumble, style hair, sudden movement, support, "
    "sway, swim, swing body part, swipe, t pose, take/pick something up, tap, telephone call, throw, tie, "
    "to lower a body part, touch ground, touch object, touching body part, touching face, transition, trip, turn, "
    "twist, upper body movements, waist movements, wait, walk, wash, wave, wiggle, wobble, wrist movements, yoga, "
    "zombie";

/// A JSON value with the path that leads to it, for messages.
struct BabelPlace {
  const ordered_json* value = nullptr;
  std::string path;
  const std::string* file = nullptr;

  tl::unexpected<Error> Bad(const std::string& rule) const {
    return Fail(ErrorCode::kMalformed, rule, *file + ":" + DisplayPath(path),
                "correct it, or remove the file from ingest.source.annotations");
  }
  /// A JSON null for an absent key.
  BabelPlace Find(const char* key) const {
    static const ordered_json kNull;
    const auto found = value->find(key);
    return {found == value->end() ? &kNull : &*found, path + "/" + key, file};
  }
  BabelPlace Item(std::size_t i) const { return {&(*value)[i], path + "/" + std::to_string(i), file}; }

  Status Text(std::string& text) const {
    if (!value->is_string()) return Bad("a text is expected");
    text = value->get<std::string>();
    return {};
  }
  Status Text(std::optional<std::string>& text) const {
    if (value->is_null()) return {};
    text.emplace();
    return Text(*text);
  }
  /// Empty for null.
  Status TextIfAny(std::string& text) const { return value->is_null() ? Status{} : Text(text); }
  Status Number(double& number) const {
    if (!value->is_number()) return Bad("a number is expected");
    number = value->get<double>();
    return std::isfinite(number) ? Status{} : Status(Bad("a finite number is expected"));
  }
  Status Number(std::optional<double>& number) const {
    if (value->is_null()) return {};
    number.emplace();
    return Number(*number);
  }
};

Expected<BabelLabel> Label(const BabelPlace& place, bool timed) {
  if (!place.value->is_object()) return place.Bad("a label is expected");
  BabelLabel label;
  if (Status s = place.Find("raw_label").Text(label.raw_label); !s) return Forward(s);
  if (Status s = place.Find("proc_label").Text(label.proc_label); !s) return Forward(s);
  if (Status s = place.Find("seg_id").TextIfAny(label.seg_id); !s) return Forward(s);
  if (timed) {
    if (Status s = place.Find("start_t").Number(label.start_t); !s) return Forward(s);
    if (Status s = place.Find("end_t").Number(label.end_t); !s) return Forward(s);
  }
  const BabelPlace categories = place.Find("act_cat");
  if (categories.value->is_null()) return label;
  if (!categories.value->is_array()) return categories.Bad("a list of categories is expected");
  label.act_cat.emplace();
  for (std::size_t i = 0; i < categories.value->size(); ++i) {
    std::string category;
    if (Status s = categories.Item(i).Text(category); !s) return Forward(s);
    label.act_cat->push_back(std::move(category));
  }
  return label;
}

Expected<BabelAnnotation> Annotation(const BabelPlace& place, bool timed) {
  if (!place.value->is_object()) return place.Bad("an annotation is expected");
  BabelAnnotation annotation;
  if (Status s = place.Find("babel_lid").TextIfAny(annotation.babel_lid); !s) return Forward(s);
  if (Status s = place.Find("anntr_id").TextIfAny(annotation.anntr_id); !s) return Forward(s);
  const BabelPlace several = place.Find("mul_act");
  if (several.value->is_boolean()) {
    annotation.mul_act = several.value->get<bool>();
  } else if (!several.value->is_null()) {
    return several.Bad("true or false is expected");
  }
  const BabelPlace labels = place.Find("labels");
  if (!labels.value->is_array()) return labels.Bad("a list of labels is expected");
  for (std::size_t i = 0; i < labels.value->size(); ++i) {
    Expected<BabelLabel> label = Label(labels.Item(i), timed);
    if (!label) return Forward(label);
    annotation.labels.push_back(std::move(*label));
  }
  return annotation;
}

/// One annotation or none under `one`, several under `many`.
Status Annotations(const BabelPlace& sequence, const char* one, const char* many, bool timed,
                   std::vector<BabelAnnotation>& annotations) {
  const BabelPlace single = sequence.Find(one), several = sequence.Find(many);
  if (!single.value->is_null()) {
    Expected<BabelAnnotation> annotation = Annotation(single, timed);
    if (!annotation) return Forward(annotation);
    annotations.push_back(std::move(*annotation));
  }
  if (several.value->is_null()) return {};
  if (!several.value->is_array()) return several.Bad("a list of annotations is expected");
  for (std::size_t i = 0; i < several.value->size(); ++i) {
    Expected<BabelAnnotation> annotation = Annotation(several.Item(i), timed);
    if (!annotation) return Forward(annotation);
    annotations.push_back(std::move(*annotation));
  }
  return {};
}

Expected<BabelSequence> Sequence(const BabelPlace& place, const std::string& key) {
  if (!place.value->is_object()) return place.Bad("a sequence is expected");
  BabelSequence sequence;
  sequence.key = key;
  const BabelPlace sid = place.Find("babel_sid");
  if (!sid.value->is_number_integer()) return sid.Bad("an integer is expected");
  sequence.babel_sid = sid.value->get<std::int64_t>();
  if (std::to_string(sequence.babel_sid) != key) {
    return sid.Bad(std::to_string(sequence.babel_sid) + " is stored under the key '" + key + "'");
  }
  if (Status s = place.Find("url").TextIfAny(sequence.url); !s) return Forward(s);
  if (Status s = place.Find("feat_p").Text(sequence.feat_p); !s) return Forward(s);
  if (Status s = place.Find("dur").Number(sequence.dur); !s) return Forward(s);
  if (sequence.dur <= 0.0) return place.Find("dur").Bad(FormatDouble(sequence.dur) + " s is not a duration");
  const bool dense = place.value->contains("seq_ann") || place.value->contains("frame_ann");
  sequence.extra = place.value->contains("seq_anns") || place.value->contains("frame_anns");
  if (dense == sequence.extra) {
    return place.Bad("either seq_ann and frame_ann (dense) or seq_anns and frame_anns (extra) are expected");
  }
  if (Status s = Annotations(place, "seq_ann", "seq_anns", false, sequence.seq_anns); !s) return Forward(s);
  if (Status s = Annotations(place, "frame_ann", "frame_anns", true, sequence.frame_anns); !s) return Forward(s);
  return sequence;
}

/// An object without the identifiers that are empty.
ordered_json WithoutEmptyTexts(ordered_json object, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (object.at(key).get_ref<const std::string&>().empty()) object.erase(key);
  }
  return object;
}

template <class T>
ordered_json OrNull(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

ordered_json ToJson(const BabelAnnotation& annotation, bool timed) {
  ordered_json labels = ordered_json::array();
  for (const BabelLabel& label : annotation.labels) {
    ordered_json entry = {{"raw_label", OrNull(label.raw_label)},
                          {"proc_label", OrNull(label.proc_label)},
                          {"seg_id", label.seg_id},
                          {"act_cat", OrNull(label.act_cat)}};
    if (timed) {
      entry["start_t"] = OrNull(label.start_t);
      entry["end_t"] = OrNull(label.end_t);
    }
    labels.push_back(WithoutEmptyTexts(std::move(entry), {"seg_id"}));
  }
  return WithoutEmptyTexts({{"babel_lid", annotation.babel_lid},
                            {"anntr_id", annotation.anntr_id},
                            {"mul_act", OrNull(annotation.mul_act)},
                            {"labels", std::move(labels)}},
                           {"babel_lid", "anntr_id"});
}

ordered_json ToJson(const std::vector<BabelAnnotation>& annotations, bool timed, bool extra) {
  if (!extra) return annotations.empty() ? ordered_json() : ToJson(annotations.front(), timed);
  ordered_json several = ordered_json::array();
  for (const BabelAnnotation& annotation : annotations) several.push_back(ToJson(annotation, timed));
  return several;
}

}  // namespace

Expected<std::vector<BabelSequence>> ParseBabel(std::string_view bytes, const std::string& name) {
  const Expected<ordered_json> root = ParseOrderedJson(bytes, name);
  if (!root) return Forward(root);
  if (!root->is_object())
    return Fail(ErrorCode::kMalformed, "an object of sequences is expected", name, "is it a file of BABEL?");
  std::vector<BabelSequence> sequences;
  for (const auto& [key, value] : root->items()) {
    Expected<BabelSequence> sequence = Sequence(BabelPlace{&value, "/" + key, &name}, key);
    if (!sequence) return Forward(sequence);
    sequences.push_back(std::move(*sequence));
  }
  return sequences;
}

std::vector<BabelProblem> FindBabelProblems(const BabelSequence& sequence) {
  std::vector<BabelProblem> problems;
  for (std::size_t a = 0; a < sequence.frame_anns.size(); ++a) {
    const std::string path =
        sequence.key + (sequence.extra ? "/frame_anns/" + std::to_string(a) : std::string("/frame_ann")) + "/labels/";
    const std::vector<BabelLabel>& labels = sequence.frame_anns[a].labels;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const BabelLabel& label = labels[i];
      std::string what;
      if (!label.start_t || !label.end_t) {
        what = "the label has no " + std::string(label.start_t ? "end_t" : "start_t");
      } else if (*label.start_t < 0.0) {
        what = "the label starts at " + FormatDouble(*label.start_t) + " s";
      } else if (*label.end_t <= *label.start_t) {
        what = "the label ends at " + FormatDouble(*label.end_t) + " s, not after its start at " +
               FormatDouble(*label.start_t) + " s";
      } else if (*label.end_t > sequence.dur + kLongestOver_s) {
        what = "the label ends at " + FormatDouble(*label.end_t) + " s, the sequence lasts " +
               FormatDouble(sequence.dur) + " s";
      }
      if (!what.empty()) problems.push_back({path + std::to_string(i), what});
    }
  }
  return problems;
}

std::string EncodeBabel(const std::vector<BabelSequence>& sequences) {
  ordered_json root = ordered_json::object();
  for (const BabelSequence& sequence : sequences) {
    ordered_json entry = {
        {"babel_sid", sequence.babel_sid}, {"url", sequence.url}, {"feat_p", sequence.feat_p}, {"dur", sequence.dur}};
    entry[sequence.extra ? "seq_anns" : "seq_ann"] = ToJson(sequence.seq_anns, false, sequence.extra);
    entry[sequence.extra ? "frame_anns" : "frame_ann"] = ToJson(sequence.frame_anns, true, sequence.extra);
    root[sequence.key] = WithoutEmptyTexts(std::move(entry), {"url"});
  }
  return root.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::vector<std::string> FrequentBabelCategories() {
  std::vector<std::string> categories;
  for (const std::string_view category : SplitText(kCategories, ',')) categories.emplace_back(Trim(category));
  return categories;
}

bool IsFrequentBabelCategory(std::string_view category) {
  static const std::vector<std::string> known = FrequentBabelCategories();
  return std::binary_search(known.begin(), known.end(), category);
}

}  // namespace mocurate
