#include <algorithm>

#include "core/motion/skeleton.h"
#include "ingest/sense/observed_clip.h"

namespace mocurate {
namespace {

/// A name without what exporters put before it, without case and separators: "mixamorig:LeftUpLeg" -> "leftupleg".
std::string PlainName(const std::string& name) {
  std::string plain;
  for (const char c : name.substr(name.rfind(':') == std::string::npos ? 0 : name.rfind(':') + 1)) {
    if (c >= 'A' && c <= 'Z')
      plain += static_cast<char>(c - 'A' + 'a');
    else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      plain += c;
  }
  return plain;
}

/// 0 left, 1 right, -1 neither; `rest` is the name without its side.
int SideOf(const std::string& name, std::string& rest) {
  const std::string plain = PlainName(name);
  rest = plain;
  for (int side = 0; side < 2; ++side) {
    const std::string word = side == 0 ? "left" : "right";
    if (const std::size_t at = plain.find(word); at != std::string::npos) {
      rest.erase(at, word.size());
      return side;
    }
  }
  if (plain.empty()) return -1;
  const bool marked_end = name.size() > 2 && (name[name.size() - 2] == '_' || name[name.size() - 2] == '.');
  for (int side = 0; side < 2; ++side) {
    const char letter = side == 0 ? 'l' : 'r';
    if (marked_end && plain.back() == letter) {
      rest.pop_back();
      return side;
    }
    const bool camel = name.size() > 1 && name[0] == (side == 0 ? 'L' : 'R') && name[1] >= 'A' && name[1] <= 'Z';
    if (plain[0] == letter && (camel || (name.size() > 1 && name[1] == '_'))) {
      rest.erase(0, 1);
      return side;
    }
  }
  return -1;
}

bool Contains(const std::string& text, const std::vector<const char*>& words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

/// Knees, elbows and head by name, their neighbours by the tree: exporters agree on the former only.
HandednessPoints PointsOfTree(const std::vector<std::string>& names, const std::vector<int>& parents) {
  HandednessPoints points;
  const auto child = [&](int joint) {
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (parents[j] == joint) return static_cast<int>(j);
    }
    return -1;
  };
  for (std::size_t j = 0; j < names.size(); ++j) {
    std::string rest;
    const int side = SideOf(names[j], rest);
    const int joint = static_cast<int>(j);
    if (side < 0) {
      if (points.head < 0 && Contains(rest, {"head"})) points.head = joint;
      continue;
    }
    const bool knee = rest == "leg" || Contains(rest, {"knee", "shin", "calf", "lowerleg", "lowleg"});
    const bool elbow = Contains(rest, {"elbow", "forearm", "lowerarm", "lowarm"});
    if (knee && points.knee[side] < 0) {
      points.knee[side] = joint;
      points.hip[side] = parents[j];
      points.ankle[side] = child(joint);
      if (points.ankle[side] >= 0) points.toe[side] = child(points.ankle[side]);
    }
    if (elbow && points.wrist[side] < 0) {
      points.shoulder[side] = parents[j];
      points.wrist[side] = child(joint);
    }
  }
  return points;
}

}  // namespace

void FollowTree(const std::vector<int>& parents, const std::string& evidence, ObservedClip& clip) {
  clip.points = PointsOfTree(clip.names, parents);
  clip.skeleton = "own tree of " + std::to_string(clip.joints) + " joints";
  clip.skeleton_from = "declared";
  clip.skeleton_confidence = 1.0;
  clip.skeleton_evidence = evidence;
  for (const char* known : {"bandai22", "cmu31", "smpl24"}) {
    const auto skeleton = KnownSkeleton(known);
    if (!skeleton || (*skeleton)->joint_count() != clip.joints) continue;
    const bool same = std::all_of(clip.names.begin(), clip.names.end(),
                                  [&](const std::string& joint) { return (*skeleton)->FindJoint(joint).has_value(); });
    if (!same) continue;
    clip.skeleton = known;
    if (clip.points.knee[0] < 0) FollowFormat(known, clip.names, evidence, clip);
  }
}

}  // namespace mocurate
