#include "core/motion/limbs.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace mocurate {
namespace {

bool Contains(const std::string& text, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return text.find(word) != std::string::npos; });
}

/// A name without its case, separators and side.
struct SidedName {
  int side = -1;  ///< 0 left, 1 right, -1 neither
  std::string rest;
};

SidedName SidedNameOf(const std::string& name) {
  SidedName sided;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z')
      sided.rest += static_cast<char>(c - 'A' + 'a');
    else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      sided.rest += c;
  }
  for (int side = 0; side < 2; ++side) {
    const std::string_view word = side == 0 ? "left" : "right";
    const std::size_t at = sided.rest.find(word);
    if (at == std::string::npos) continue;
    sided.rest.erase(at, word.size());
    sided.side = side;
    return sided;
  }
  const std::size_t size = name.size();
  if (size < 3 || sided.rest.size() < 2) return sided;
  const auto is_separator = [](char c) { return c == '_' || c == '.' || c == ' ' || c == '-'; };
  for (int side = 0; side < 2; ++side) {
    const char letter = side == 0 ? 'l' : 'r';
    if (is_separator(name[size - 2]) && sided.rest.back() == letter) {
      sided.rest.pop_back();
      sided.side = side;
    } else if (sided.rest.front() == letter &&
               (is_separator(name[1]) || (name[0] == letter - 'a' + 'A' && name[1] >= 'A' && name[1] <= 'Z'))) {
      sided.rest.erase(0, 1);
      sided.side = side;
    } else {
      continue;
    }
    break;
  }
  return sided;
}

class LimbFinder {
 public:
  explicit LimbFinder(const Skeleton& skeleton) : skeleton_(skeleton), children_(skeleton.Children()) {
    std::vector<std::string> names;
    for (const Joint& joint : skeleton.joints) names.push_back(joint.name);
    for (const std::string& name : WithoutNamespace(std::move(names))) names_.push_back(SidedNameOf(name));
  }

  Limbs Find() const {
    Limbs limbs;
    for (int side = 0; side < 2; ++side) {
      limbs.arm[side] = Arm(side);
      limbs.leg[side] = Leg(side);
    }
    const std::array<Limb, 2>& arm = limbs.arm;
    if (arm[0].collar >= 0 && arm[1].collar >= 0) {
      const int above = Above(arm[0].collar);
      if (above >= 0 && above == Above(arm[1].collar)) limbs.chest = above;
    }
    limbs.pelvis = CommonAbove(limbs.leg[0].root, limbs.leg[1].root);
    return limbs;
  }

 private:
  int CommonAbove(int a, int b) const {
    if (a < 0 || b < 0) return -1;
    while (a != b) {  // parents come first: the later of the two cannot be above the other
      int& later = a > b ? a : b;
      later = skeleton_.joints[later].parent;
    }
    return a;
  }

  static bool SharesTwist(const SidedName& name) { return Contains(name.rest, {"twist", "roll"}); }

  int Above(int joint) const {
    int above = skeleton_.joints[joint].parent;
    while (above >= 0 && SharesTwist(names_[above])) above = skeleton_.joints[above].parent;
    return above;
  }

  /// Shoulder or hip; the root of the whole tree is neither.
  int RootOf(int middle) const {
    const int above = Above(middle);
    return above > 0 ? above : -1;
  }

  /// Its descendants, by way of joints that share its twist.
  std::vector<int> Below(int joint) const {
    std::vector<int> below;
    for (const int child : children_[joint]) {
      if (!SharesTwist(names_[child])) {
        below.push_back(child);
        continue;
      }
      const std::vector<int> farther = Below(child);
      below.insert(below.end(), farther.begin(), farther.end());
    }
    return below;
  }

  /// The child that continues the limb: the only one, else the first whose name has one of the words; -1 for none.
  int ContinuesWith(const std::vector<int>& below, std::initializer_list<std::string_view> words) const {
    if (below.size() == 1) return below.front();
    const auto named =
        std::find_if(below.begin(), below.end(), [&](int joint) { return Contains(names_[joint].rest, words); });
    return named == below.end() ? -1 : *named;
  }

  /// By the skeleton's own name or synonym, else the first with a matching name below a joint of its side.
  template <typename IsMiddle>
  int Middle(int side, const char* standard, const IsMiddle& is_middle) const {
    const std::string name = std::string(side == 0 ? "left_" : "right_") + standard;
    if (const std::optional<int> known = skeleton_.FindJoint(name)) return *known;
    for (int j = 1; j < skeleton_.joint_count(); ++j) {
      const bool hangs = Above(j) >= 0 && names_[Above(j)].side == side;
      if (names_[j].side == side && hangs && !SharesTwist(names_[j]) && is_middle(names_[j].rest)) return j;
    }
    return -1;
  }

  Limb Arm(int side) const {
    Limb limb;
    limb.middle = Middle(side, "elbow", [](const std::string& rest) {
      return Contains(rest, {"elbow", "forearm", "lowerarm", "lowarm"});
    });
    if (limb.middle < 0) return limb;
    limb.root = RootOf(limb.middle);
    const int above = limb.root < 0 ? -1 : Above(limb.root);
    const bool sided = above > 0 && (names_[above].side == side || Contains(names_[above].rest, {"clav", "collar"}));
    if (sided) limb.collar = above;
    limb.end = ContinuesWith(Below(limb.middle), {"wrist", "hand"});
    if (limb.end < 0) return limb;
    std::vector<int> fingers = Below(limb.end);
    fingers.erase(std::remove_if(fingers.begin(), fingers.end(),
                                 [&](int joint) { return Contains(names_[joint].rest, {"thumb"}); }),
                  fingers.end());
    limb.tip = ContinuesWith(fingers, {"middle"});
    return limb;
  }

  Limb Leg(int side) const {
    Limb limb;
    limb.middle = Middle(side, "knee", [](const std::string& rest) {
      return rest == "leg" || Contains(rest, {"knee", "shin", "calf", "lowerleg", "lowleg"});
    });
    if (limb.middle < 0) return limb;
    limb.root = RootOf(limb.middle);
    limb.end = ContinuesWith(Below(limb.middle), {"ankle", "foot"});
    if (limb.end < 0) return limb;
    std::vector<int> toes = Below(limb.end);
    toes.erase(
        std::remove_if(toes.begin(), toes.end(), [&](int joint) { return Contains(names_[joint].rest, {"heel"}); }),
        toes.end());
    limb.tip = ContinuesWith(toes, {"toe", "foot", "ball"});
    return limb;
  }

  const Skeleton& skeleton_;
  std::vector<std::vector<int>> children_;
  std::vector<SidedName> names_;
};

}  // namespace

Limbs LimbsOf(const Skeleton& skeleton) { return LimbFinder(skeleton).Find(); }

}  // namespace mocurate
