#include "core/formats/humanact12_names.h"

#include <algorithm>
#include <array>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr std::array<HumanAct12Code, 34> kCodes = {{
    {"0101", "warm_up", "warm_up_wrist_ankle"},
    {"0102", "warm_up", "warm_up_pectoral"},
    {"0103", "warm_up", "warm_up_elbow_back"},
    {"0104", "warm_up", "warm_up_body_lean_right_arm"},
    {"0105", "warm_up", "warm_up_body_lean_left_arm"},
    {"0106", "warm_up", "warm_up_bow_right"},
    {"0107", "warm_up", "warm_up_bow_left"},
    {"0201", "walk", "walk"},
    {"0301", "run", "run"},
    {"0401", "jump", "jump_hands_up"},
    {"0402", "jump", "jump_vertical"},
    {"0501", "drink", "drink_bottle_right_hand"},
    {"0502", "drink", "drink_bottle_left_hand"},
    {"0503", "drink", "drink_cup_right_hand"},
    {"0504", "drink", "drink_cup_left_hand"},
    {"0505", "drink", "drink_both_hands"},
    {"0601", "lift_dumbbell", "lift_dumbbell_right_hand"},
    {"0602", "lift_dumbbell", "lift_dumbbell_left_hand"},
    {"0603", "lift_dumbbell", "lift_dumbbell_both_hands"},
    {"0604", "lift_dumbbell", "lift_dumbbell_overhead"},
    {"0605", "lift_dumbbell", "lift_dumbbell_both_hands_bend_legs"},
    {"0701", "sit", "sit"},
    {"0801", "eat", "eat_right_hand"},
    {"0802", "eat", "eat_left_hand"},
    {"0803", "eat", "eat_pie_burger"},
    {"0901", "turn_steering_wheel", "turn_steering_wheel"},
    {"1001", "phone", "phone_take_out_call_put_back"},
    {"1002", "phone", "phone_call_left_hand"},
    {"1101", "boxing", "boxing_left_right"},
    {"1102", "boxing", "boxing_left_upwards"},
    {"1103", "boxing", "boxing_right_upwards"},
    {"1104", "boxing", "boxing_right_left"},
    {"1201", "throw", "throw_right_hand"},
    {"1202", "throw", "throw_both_hands"},
}};

/// A number of `digits` digits after the letter `tag` (none where it is 0), taken off the front of the text.
std::optional<int> TakeDigits(char tag, std::size_t digits, std::string_view& text) {
  if (tag != 0) {
    if (text.empty() || text[0] != tag) return std::nullopt;
    text.remove_prefix(1);
  }
  const std::string_view part = text.substr(0, digits);
  const bool whole =
      part.size() == digits && std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!whole) return std::nullopt;
  text.remove_prefix(digits);
  return static_cast<int>(*ParseInteger(part));
}

}  // namespace

const HumanAct12Code* FindHumanAct12Code(std::string_view code) {
  const auto* found =
      std::find_if(kCodes.begin(), kCodes.end(), [&](const HumanAct12Code& entry) { return entry.code == code; });
  return found == kCodes.end() ? nullptr : found;
}

std::optional<HumanAct12Name> ParseHumanAct12Name(std::string_view text) {
  const bool tagged = !text.empty() && text[0] == 'P';
  const std::size_t width = tagged ? 2 : 1;  // of group and repetition
  const auto tag = [&](char letter) { return tagged ? letter : '\0'; };
  HumanAct12Name name;
  const auto subject = TakeDigits(tag('P'), 2, text);
  const auto group = subject ? TakeDigits(tag('G'), width, text) : std::nullopt;
  const auto time = group ? TakeDigits(tag('R'), width, text) : std::nullopt;
  const auto first = time ? TakeDigits(tag('F'), 4, text) : std::nullopt;
  const auto last = first ? TakeDigits(tag('T'), 4, text) : std::nullopt;
  if (!last) return std::nullopt;
  const std::string_view action = text;
  if (!TakeDigits(tag('A'), 4, text)) return std::nullopt;
  name.code = action.substr(tagged ? 1 : 0, 4);
  if (!text.empty() && !(tagged && text == ".npy")) return std::nullopt;
  name.recording = {*subject, *group, *time};
  name.first = *first;
  name.last = *last;
  return name;
}

}  // namespace mocurate
