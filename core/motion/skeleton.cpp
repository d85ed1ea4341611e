#include "core/motion/skeleton.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace mocurate {
namespace {

bool IsSeparator(char c) { return c == ' ' || c == '_' || c == '-'; }

char LowerCase(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Lower case without blanks, '_' and '-': "Left_Knee", "left knee" and "leftKnee" are one name.
std::string Normalised(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (!IsSeparator(c)) text.push_back(LowerCase(c));
  }
  return text;
}

/// Whether Normalised(name) is `key`. Names are looked up in every fit of a frame: nothing is copied.
bool IsNamed(std::string_view name, std::string_view key) {
  std::size_t at = 0;
  for (const char c : name) {
    if (IsSeparator(c)) continue;
    if (at == key.size() || LowerCase(c) != key[at]) return false;
    ++at;
  }
  return at == key.size();
}

std::string Label(const Skeleton& skeleton, int joint) {
  return "joint " + std::to_string(joint) + " ('" + skeleton.joints[joint].name + "')";
}

tl::unexpected<Error> BrokenSkeleton(const Skeleton& skeleton, const std::string& what, const std::string& hint = {}) {
  return Fail(ErrorCode::kInconsistent, what, "skeleton '" + skeleton.name + "'", hint);
}

std::optional<std::array<int, 2>> Pair(const Skeleton& skeleton, const char* left, const char* right) {
  const std::optional<int> l = skeleton.FindJoint(left);
  const std::optional<int> r = skeleton.FindJoint(right);
  if (!l || !r || *l == *r) return std::nullopt;
  return std::array<int, 2>{*l, *r};
}

Status CheckNames(const Skeleton& s) {
  std::map<std::string, std::string> seen;  // normalised -> who uses it
  const auto claim = [&](const std::string& name, const std::string& owner) -> Status {
    const std::string key = Normalised(name);
    if (key.empty()) return BrokenSkeleton(s, "the name of " + owner + " is empty");
    const auto [place, fresh] = seen.emplace(key, owner);
    if (fresh) return {};
    return BrokenSkeleton(s, "the name '" + name + "' stands for " + place->second + " and for " + owner,
                          "names and synonyms must differ in more than case, blanks, '_' and '-'");
  };
  for (int j = 0; j < s.joint_count(); ++j) {
    if (Status ok = claim(s.joints[j].name, Label(s, j)); !ok) return ok;
  }
  for (const Landmark& landmark : s.landmarks) {
    if (Status ok = claim(landmark.name, "landmark '" + landmark.name + "'"); !ok) return ok;
  }
  for (int j = 0; j < s.joint_count(); ++j) {
    for (const std::string& synonym : s.joints[j].synonyms) {
      if (Status ok = claim(synonym, Label(s, j)); !ok) return ok;
    }
  }
  return {};
}

Status CheckTree(const Skeleton& s) {
  if (s.joints.empty()) return BrokenSkeleton(s, "no joints");
  for (int j = 0; j < s.joint_count(); ++j) {
    const Joint& joint = s.joints[j];
    if (j == 0 && joint.parent != -1)
      return BrokenSkeleton(s, Label(s, j) + " is the first joint and must have no parent");
    if (j > 0 && (joint.parent < 0 || joint.parent >= j)) {
      return BrokenSkeleton(s, Label(s, j) + " has parent " + std::to_string(joint.parent),
                            "exactly the first joint is the root; parents come before their children");
    }
    if (!joint.rest_offset.allFinite() || joint.rest_offset.norm() > 10.0) {
      return BrokenSkeleton(s, Label(s, j) + " has a rest offset that is not finite or longer than 10 m",
                            "offsets are metres");
    }
    if (j == 0 && !joint.rest_offset.isZero(0.0)) return BrokenSkeleton(s, "the root's rest offset must be zero");
    if (!(joint.radius > 0.0 && joint.radius < 1.0))
      return BrokenSkeleton(s, Label(s, j) + " has a radius outside (0, 1) m");
    if (joint.limits) {
      const JointLimits& l = *joint.limits;
      if (!l.min.allFinite() || !l.max.allFinite() || (l.min.array() > l.max.array()).any()) {
        return BrokenSkeleton(s, Label(s, j) + " has limits that are not finite or have min above max");
      }
    }
  }
  for (const Landmark& landmark : s.landmarks) {
    if (landmark.joint < 0 || landmark.joint >= s.joint_count() || !landmark.offset.allFinite()) {
      return BrokenSkeleton(s,
                            "landmark '" + landmark.name + "' refers to no joint or has an offset that is not finite");
    }
  }
  return {};
}

Status CheckMirror(const Skeleton& s) {
  for (int j = 0; j < s.joint_count(); ++j) {
    const int m = s.joints[j].mirror;
    if (m < 0 || m >= s.joint_count()) return BrokenSkeleton(s, Label(s, j) + " has no mirror partner");
    if (s.joints[m].mirror != j) {
      return BrokenSkeleton(s, Label(s, j) + " names " + Label(s, m) + " as mirror partner, which names another one");
    }
    const int p = s.joints[j].parent;
    if ((p < 0) != (s.joints[m].parent < 0) || (p >= 0 && s.joints[p].mirror != s.joints[m].parent)) {
      return BrokenSkeleton(s, Label(s, j) + " and its mirror partner have parents that are not mirror partners");
    }
    if (!s.joints[j].reflection) continue;
    const Matrix3d& r = *s.joints[j].reflection;
    if (!r.allFinite() || (r * r.transpose() - Matrix3d::Identity()).norm() > 1e-9 || r.determinant() > 0) {
      return BrokenSkeleton(s, Label(s, j) + " has a reflection that is not orthogonal with determinant -1");
    }
    if (!s.joints[m].reflection || (*s.joints[m].reflection - r.transpose()).norm() > 1e-9) {
      return BrokenSkeleton(s, Label(s, j) + " and its mirror partner have reflections that do not undo each other");
    }
  }
  return {};
}

Status CheckLie(const Skeleton& s) {
  const LieChains& lie = *s.lie;
  if (static_cast<int>(lie.raw_offsets.size()) != s.joint_count()) {
    return BrokenSkeleton(
        s, std::to_string(lie.raw_offsets.size()) + " Lie offsets for " + std::to_string(s.joint_count()) + " joints");
  }
  for (int j = 0; j < s.joint_count(); ++j) {
    const double norm = lie.raw_offsets[j].norm();
    if (std::abs(norm - (j == 0 ? 0.0 : 1.0)) <= 1e-9) continue;
    return BrokenSkeleton(s, Label(s, j) + " has a Lie offset of length " + std::to_string(norm),
                          "the root's is zero, all others are unit vectors");
  }
  std::vector<bool> reached(s.joints.size(), false);
  reached[0] = true;
  for (const std::vector<int>& chain : lie.chains) {
    if (chain.size() < 2) return BrokenSkeleton(s, "a Lie chain has fewer than two joints");
    for (std::size_t i = 0; i < chain.size(); ++i) {
      if (chain[i] < 0 || chain[i] >= s.joint_count())
        return BrokenSkeleton(s, "a Lie chain names a joint that does not exist");
      if (i == 0 && !reached[chain[0]]) {
        return BrokenSkeleton(s, "a Lie chain starts at " + Label(s, chain[0]) + ", which no earlier chain reaches");
      }
      if (i > 0 && reached[chain[i]]) return BrokenSkeleton(s, Label(s, chain[i]) + " is reached by two Lie chains");
      reached[chain[i]] = true;
    }
  }
  for (int j = 0; j < s.joint_count(); ++j) {
    if (!reached[j]) return BrokenSkeleton(s, Label(s, j) + " is in no Lie chain");
  }
  return {};
}

constexpr std::size_t kFewestNames = 5;  // least names for a common prefix
constexpr std::string_view kSeparators = "_ .-";

bool IsCapital(char c) { return c >= 'A' && c <= 'Z'; }

/// What all but the first begin with.
std::string_view SharedBeginning(const std::vector<std::string>& names) {
  std::string_view shared = names[1];
  for (std::size_t j = 2; j < names.size(); ++j) {
    const auto differs = std::mismatch(shared.begin(), shared.end(), names[j].begin(), names[j].end()).first;
    shared = shared.substr(0, static_cast<std::size_t>(differs - shared.begin()));
  }
  return shared;
}

/// Length of the prefix that is not part of a joint's own name.
std::size_t NamespaceLength(const std::vector<std::string>& names, std::string_view shared) {
  for (std::size_t length = shared.size(); length > 0; --length) {
    if (kSeparators.find(shared[length - 1]) != std::string_view::npos) return length;
    const bool capitals = !IsCapital(shared[length - 1]) &&
                          std::all_of(names.begin() + 1, names.end(),
                                      [&](auto& name) { return name.size() > length && IsCapital(name[length]); });
    if (capitals) return length;
  }
  return 0;
}

}  // namespace

std::optional<int> HingeAxis(const JointLimits& limits) {
  constexpr double kMostBackwards = 0.5, kRightAngle = 1.5708;  // radians
  for (int i = 0; i < 3; ++i) {
    const double less = std::min(-limits.min[i], limits.max[i]);
    const double more = std::max(-limits.min[i], limits.max[i]);
    if (less < kMostBackwards && more > kRightAngle) return i;
  }
  return {};
}

std::optional<int> Skeleton::FindJoint(std::string_view searched) const {
  const std::string key = Normalised(searched);
  if (key.empty()) return std::nullopt;
  for (int j = 0; j < joint_count(); ++j) {
    if (IsNamed(joints[j].name, key)) return j;
  }
  for (int j = 0; j < joint_count(); ++j) {
    for (const std::string& synonym : joints[j].synonyms) {
      if (IsNamed(synonym, key)) return j;
    }
  }
  return std::nullopt;
}

std::vector<std::vector<int>> Skeleton::Children() const {
  std::vector<std::vector<int>> children(joints.size());
  for (int j = 0; j < joint_count(); ++j) {
    if (joints[j].parent >= 0) children[joints[j].parent].push_back(j);
  }
  return children;
}

std::vector<double> Skeleton::RestBoneLengths() const {
  std::vector<double> lengths(joints.size(), 0.0);
  for (int j = 1; j < joint_count(); ++j) lengths[j] = joints[j].rest_offset.norm();
  return lengths;
}

std::optional<std::array<int, 2>> Skeleton::Hips() const {
  const auto hips = Pair(*this, "left_hip", "right_hip");
  return hips ? hips : Shoulders();
}

std::optional<std::array<int, 2>> Skeleton::Shoulders() const { return Pair(*this, "left_shoulder", "right_shoulder"); }

Matrix3d Skeleton::Reflection(int joint) const {
  std::vector<std::array<Vector3d, 2>> pairs;  // direction to a child, and to its partner
  for (int c = 1; c < joint_count(); ++c) {
    if (joints[c].parent != joint) continue;
    const Vector3d& own = joints[c].rest_offset;
    const Vector3d& partner = joints[joints[c].mirror].rest_offset;
    if (own.norm() > 0 && partner.norm() > 0) pairs.push_back({own.normalized(), partner.normalized()});
  }
  Matrix3d reflection = Vector3d(-1, 1, 1).asDiagonal();
  if (joints[joint].reflection) {
    reflection = *joints[joint].reflection;
  } else {
    double best = std::numeric_limits<double>::infinity();
    for (const Vector3d& signs : {Vector3d(-1, 1, 1), Vector3d(1, -1, 1), Vector3d(1, 1, -1), Vector3d(-1, -1, -1)}) {
      double misfit = 0;
      for (const auto& [own, partner] : pairs) misfit += (signs.cwiseProduct(own) - partner).squaredNorm();
      if (misfit > best - 1e-6) continue;
      best = misfit;
      reflection = signs.asDiagonal();
    }
  }
  if (pairs.size() != 1) return reflection;
  return SwingBetween(reflection * pairs[0][0], pairs[0][1]).toRotationMatrix() * reflection;
}

std::vector<int> Skeleton::LieParents() const {
  std::vector<int> parents(joints.size(), -1);
  for (const std::vector<int>& chain : lie->chains) {
    for (std::size_t i = 1; i < chain.size(); ++i) parents[chain[i]] = chain[i - 1];
  }
  return parents;
}

Status Skeleton::Check() const {
  if (name.empty()) return BrokenSkeleton(*this, "the skeleton has no name");
  if (Status ok = CheckTree(*this); !ok) return ok;
  if (Status ok = CheckNames(*this); !ok) return ok;
  if (Status ok = CheckMirror(*this); !ok) return ok;
  return lie ? CheckLie(*this) : Status{};
}

bool SameTree(const Skeleton& a, const Skeleton& b) {
  return std::equal(a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(),
                    [](const Joint& x, const Joint& y) { return x.name == y.name && x.parent == y.parent; });
}

double RestPosesApart(const Skeleton& a, const Skeleton& b) {
  double farthest = 0.0;
  for (const std::vector<int>& children : a.Children()) {
    Matrix3d shared = Matrix3d::Zero();
    double size = 0.0;
    for (const int child : children) {
      const Vector3d& u = a.joints[static_cast<std::size_t>(child)].rest_offset;
      const Vector3d& v = b.joints[static_cast<std::size_t>(child)].rest_offset;
      shared += u * v.transpose();
      size += u.norm() * v.norm();
      if (children.size() == 1) farthest = std::max(farthest, std::atan2(u.cross(v).norm(), u.dot(v)));
    }
    if (children.size() < 2 || size == 0.0) continue;
    const Eigen::JacobiSVD<Matrix3d> svd(shared, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const bool mirrored = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0;
    const Vector3d& values = svd.singularValues();
    const double best = values.x() + values.y() + (mirrored ? -values.z() : values.z());
    farthest = std::max(farthest, std::sqrt(2.0 * std::max(0.0, best - shared.trace()) / size));
  }
  return farthest;
}

bool SameRestOffsets(const Skeleton& a, const Skeleton& b) {
  return std::equal(a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(),
                    [](const Joint& x, const Joint& y) { return x.rest_offset == y.rest_offset; });
}

SkeletonPtr WithRestOffsetsOf(const Skeleton& skeleton, const Skeleton& other) {
  auto own = std::make_shared<Skeleton>(skeleton);
  for (std::size_t j = 0; j < own->joints.size(); ++j) own->joints[j].rest_offset = other.joints[j].rest_offset;
  return own;
}

std::vector<std::string> WithoutNamespace(std::vector<std::string> names) {
  const std::vector<std::string> whole = names;
  for (std::string& name : names) {
    const std::size_t colon = name.find_last_of(":|");
    if (colon != std::string::npos && colon + 1 < name.size()) name.erase(0, colon + 1);
  }
  if (names.size() > kFewestNames) {
    const std::string shared(SharedBeginning(names));
    if (const std::size_t length = NamespaceLength(names, shared); length > 0) {
      for (std::string& name : names) {
        if (name.size() > length && name.compare(0, length, shared, 0, length) == 0) name.erase(0, length);
      }
    }
  }
  const auto distinct = [](const std::vector<std::string>& list) {
    return std::set<std::string>(list.begin(), list.end()).size();
  };
  return distinct(names) < distinct(whole) ? whole : names;
}

std::vector<std::string> NamesIn(const Skeleton& skeleton, const std::vector<std::string>& names) {
  const bool known = std::all_of(names.begin(), names.end(),
                                 [&](const std::string& name) { return skeleton.FindJoint(name).has_value(); });
  return known ? names : WithoutNamespace(names);
}

}  // namespace mocurate
