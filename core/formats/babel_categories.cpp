#include <algorithm>

#include "core/base/text.h"
#include "core/formats/babel.h"

namespace mocurate {
namespace {

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

}  // namespace

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
