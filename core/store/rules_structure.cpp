#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/text.h"
#include "core/motion/kinematics.h"
#include "core/store/fields.h"
#include "core/store/rules.h"

namespace mocurate::store {
namespace {

using Problem = std::optional<std::string>;

constexpr double kJointTolerance = 1e-3;  // metres; float32 far from the origin stays well below

std::string Row(std::size_t row) { return "[" + std::to_string(row) + "] "; }

Problem JointsProblem(const RuleContext& c, const SkeletonPtr& of_file) {
  const auto& joints = c.array.as<float>();
  const auto& roots = c.content.Values<float>(c.prefix + "/frames/root_translation");
  const auto& rotations = c.content.Values<float>(c.prefix + "/frames/rotation");
  const auto& offsets = c.content.Values<std::int64_t>(c.prefix + "/clips/offset");
  const auto& counts = c.content.Values<std::int64_t>(c.prefix + "/clips/count");
  const auto& lengths = c.content.Values<double>(c.prefix + "/clips/bone_length");
  const std::size_t J = of_file->joints.size();
  const std::size_t F = c.array.shape[0];
  std::vector<Quaterniond> rotation(J);
  std::vector<Vector3d> expected(J);
  for (std::size_t clip = 0; clip < offsets.size(); ++clip) {
    const auto row = static_cast<std::ptrdiff_t>(clip * J);
    const std::vector<double> bone_length(lengths.begin() + row, lengths.begin() + row + static_cast<int>(J));
    const auto begin = static_cast<std::uint64_t>(offsets[clip]);
    const auto end = begin + static_cast<std::uint64_t>(counts[clip]);
    if (begin > F || end > F || end < begin) return std::nullopt;  // the rule of /clips/offset reports it
    const SkeletonPtr skeleton = WithRestOffsets(c.content, c.prefix, clip, of_file);
    if (skeleton != of_file) {
      if (const Status sound = skeleton->Check(); !sound)
        return "of a skeleton whose /clips/rest_offset is invalid: " + sound.error().what;
    }
    for (std::size_t f = begin; f < end; ++f) {
      for (std::size_t j = 0; j < J; ++j) {
        const float* q = &rotations[4 * (f * J + j)];
        rotation[j] = Quaterniond(q[0], q[1], q[2], q[3]);
      }
      const Vector3d root(roots[3 * f], roots[3 * f + 1], roots[3 * f + 2]);
      ForwardKinematics(*skeleton, root, rotation.data(), bone_length, expected.data());
      for (std::size_t j = 0; j < J; ++j) {
        const float* p = &joints[3 * (f * J + j)];
        const double distance = (Vector3d(p[0], p[1], p[2]) - expected[j]).norm();
        if (distance <= kJointTolerance) continue;
        return "[" + std::to_string(f) + ", " + std::to_string(j) + "] (" + skeleton->joints[j].name + ") lies " +
               FormatDouble(distance) + " m from where the rotations put it";
      }
    }
  }
  return std::nullopt;
}

}  // namespace

Rule Parents() {
  return {"-1 for joint 0, then below the joint's own position", [](const RuleContext& c) -> Problem {
            const auto& parents = c.array.as<std::int32_t>();
            for (std::size_t j = 0; j < parents.size(); ++j) {
              const bool good = j == 0 ? parents[j] == -1 : parents[j] >= 0 && parents[j] < static_cast<int>(j);
              if (!good) return Row(j) + "is " + std::to_string(parents[j]);
            }
            return parents.empty() ? Problem("has no joints") : std::nullopt;
          }};
}

Rule MirrorPartners() {
  return {"a joint whose partner is this one", [](const RuleContext& c) -> Problem {
            const auto& mirror = c.array.as<std::int32_t>();
            const int count = static_cast<int>(mirror.size());
            for (int j = 0; j < count; ++j) {
              const int partner = mirror[static_cast<std::size_t>(j)];
              if (partner < 0 || partner >= count || mirror[static_cast<std::size_t>(partner)] != j) {
                return Row(static_cast<std::size_t>(j)) + "is " + std::to_string(partner);
              }
            }
            return std::nullopt;
          }};
}

Rule ChainLengths() {
  return {"at least 1; together the rows of chain_joint", [](const RuleContext& c) -> Problem {
            const Array* joints = c.Sibling("chain_joint");
            std::uint64_t total = 0;
            for (const std::int32_t length : c.array.as<std::int32_t>()) {
              if (length < 1) return "has a chain of " + std::to_string(length) + " joints";
              total += static_cast<std::uint64_t>(length);
            }
            if (joints == nullptr || total != joints->rows()) {
              return "sums to " + std::to_string(total) + ", not to the rows of " + c.prefix +
                     "/skeleton/lie/chain_joint";
            }
            return std::nullopt;
          }};
}

Rule SortedIds() {
  return {"rising in byte order, no two alike; source/person/recording#begin-end", [](const RuleContext& c) -> Problem {
            const auto& ids = c.array.as<std::string>();
            for (std::size_t i = 1; i < ids.size(); ++i) {
              if (!(ids[i - 1] < ids[i])) return Row(i) + "'" + ids[i] + "' follows '" + ids[i - 1] + "'";
            }
            const bool spelled = c.content.Has("/clips/source") && c.content.Has("/clips/end_frame");
            for (std::size_t i = 0; spelled && i < ids.size(); ++i) {
              const std::string expected = IdentityOf(c.content, i).id();
              if (ids[i] != expected) return Row(i) + "is '" + ids[i] + "'; its parts spell '" + expected + "'";
            }
            return std::nullopt;
          }};
}

Rule OffsetsTileFrames() {
  return {"0, then the sum of the counts before; the last ends with /frames", [](const RuleContext& c) -> Problem {
            const auto& offsets = c.array.as<std::int64_t>();
            const auto& counts = c.content.Values<std::int64_t>(c.prefix + "/clips/count");
            const std::uint64_t frames = c.content.fields.at(c.prefix + "/frames/joints").rows();
            std::uint64_t expected = 0;
            for (std::size_t i = 0; i < offsets.size(); ++i) {
              if (offsets[i] < 0 || static_cast<std::uint64_t>(offsets[i]) != expected) {
                return Row(i) + "is " + std::to_string(offsets[i]) + "; " + std::to_string(expected) +
                       " is the end of the clip before";
              }
              if (counts[i] < 1 || static_cast<std::uint64_t>(counts[i]) > frames - expected) {
                return Row(i) + "has count " + std::to_string(counts[i]) + " of " + std::to_string(frames) + " frames";
              }
              expected += static_cast<std::uint64_t>(counts[i]);
            }
            if (expected == frames) return std::nullopt;
            return "the clips end at frame " + std::to_string(expected) + " of " + std::to_string(frames);
          }};
}

Rule RateOfClips() {
  return {"the rate of every clip, or mixed", [](const RuleContext& c) -> Problem {
            const std::string& rate = c.array.as<std::string>()[0];
            const std::string common = CommonRate(c.content.Values<std::string>("/clips/rate"));
            if (rate == common) return std::nullopt;
            return "is '" + rate + "'; the clips declare '" + common + "'";
          }};
}

Rule ClassOfLabel() {
  return {"the row of /clips/label in /labels/name, or -1", [](const RuleContext& c) -> Problem {
            const auto& classes = c.array.as<std::int32_t>();
            const auto& labels = c.content.Values<std::string>("/clips/label");
            const Array* names = c.content.Find("/labels/name");
            const std::vector<std::string> none;
            const auto& known = names == nullptr ? none : names->as<std::string>();
            for (std::size_t i = 0; i < classes.size(); ++i) {
              const auto own = static_cast<std::size_t>(classes[i]);
              if (own < known.size() && known[own] == labels[i]) continue;  // names are unique
              const auto found = std::find(known.begin(), known.end(), labels[i]);
              const int expected = found == known.end() ? -1 : static_cast<int>(found - known.begin());
              if (classes[i] != expected) {
                return Row(i) + "is " + std::to_string(classes[i]) + "; label '" + labels[i] + "' has row " +
                       std::to_string(expected);
              }
            }
            return std::nullopt;
          }};
}

Rule OptionalFieldMask() {
  return {"bits of optional fields that are there", [](const RuleContext& c) -> Problem {
            unsigned present = 0;
            for (std::size_t bit = 0; bit < kOptionalFrameFields.size(); ++bit) {
              if (c.content.Has(c.prefix + "/frames/" + kOptionalFrameFields[bit])) present |= 1u << bit;
            }
            const auto& masks = c.array.as<std::uint8_t>();
            for (std::size_t i = 0; i < masks.size(); ++i) {
              if ((masks[i] & ~present) == 0) continue;
              return Row(i) + "is " + std::to_string(masks[i]) + "; the optional fields there make " +
                     std::to_string(present);
            }
            return std::nullopt;
          }};
}

Rule SplitRows() {
  return {"a row of /clips; no row twice in one split", [](const RuleContext& c) -> Problem {
            const auto clips = static_cast<std::int64_t>(c.content.fields.at("/clips/id").rows());
            std::set<std::int32_t> seen;
            for (const char* part : {"train", "validation", "test"}) {
              const Array* rows = c.Sibling(part);
              if (rows == nullptr) continue;
              for (const std::int32_t row : rows->as<std::int32_t>()) {
                const bool own = rows == &c.array;
                if (own && (row < 0 || row >= clips)) {
                  return "names row " + std::to_string(row) + " of " + std::to_string(clips) + " clips";
                }
                if (!seen.insert(row).second && own) return "names row " + std::to_string(row) + " a second time";
              }
              if (rows == &c.array) break;
            }
            return std::nullopt;
          }};
}

Rule ForwardKinematicsJoints() {
  return {"finite; equal to forward kinematics within 1 mm", [](const RuleContext& c) -> Problem {
            if (auto problem = Finite().check(c)) return problem;
            if (c.content.Text("/@kinematics") != "tree") return std::nullopt;
            for (const char* field : {"/frames/rotation", "/clips/offset", "/clips/count", "/clips/bone_length"}) {
              if (!c.content.Has(c.prefix + field)) return std::nullopt;
            }
            return JointsProblem(c, std::make_shared<Skeleton>(UnpackSkeleton(c.content, c.prefix)));
          }};
}

Rule ViewCounts(const std::string& field) {
  return {"not negative; together the rows of " + field, [field](const RuleContext& c) -> Problem {
            const std::uint64_t images = c.content.fields.at(field).rows();
            std::uint64_t total = 0;
            for (const std::int64_t count : c.array.as<std::int64_t>()) {
              if (count < 0 || static_cast<std::uint64_t>(count) > images - total) {
                return "announces " + std::to_string(count) + " of " + std::to_string(images) + " images";
              }
              total += static_cast<std::uint64_t>(count);
            }
            if (total == images) return std::nullopt;
            return "sums to " + std::to_string(total) + " of " + std::to_string(images) + " images";
          }};
}

Rule RisingPerView() {
  return {"finite, strictly rising within a view", [](const RuleContext& c) -> Problem {
            const auto& times = c.array.as<double>();
            std::size_t begin = 0;
            for (const std::int64_t count : c.Sibling("count")->as<std::int64_t>()) {
              const std::size_t end = begin + static_cast<std::size_t>(count);
              for (std::size_t i = begin; i < end && i < times.size(); ++i) {
                if (!std::isfinite(times[i]) || (i > begin && !(times[i] > times[i - 1]))) {
                  return Row(i) + "is " + FormatDouble(times[i]);
                }
              }
              begin = end;
            }
            return std::nullopt;
          }};
}

Rule KeypointValues() {
  return {"a row per person of every image; u and v finite, confidence in [0, 1]", [](const RuleContext& c) -> Problem {
            const auto& counts = c.Sibling("count")->as<std::int64_t>();
            const auto& people = c.Sibling("people")->as<std::int32_t>();
            std::uint64_t rows = 0;  // counts are at most the rows of time_s, people are 32 bits: no overflow
            for (std::size_t view = 0; view < counts.size(); ++view) {
              rows += static_cast<std::uint64_t>(counts[view]) * static_cast<std::uint64_t>(people[view]);
            }
            if (rows != c.array.rows()) {
              return "has " + std::to_string(c.array.rows()) + " rows; count and people ask for " +
                     std::to_string(rows);
            }
            const auto& values = c.array.as<double>();
            for (std::size_t i = 0; i < values.size(); ++i) {
              const bool good = i % 3 == 2 ? values[i] >= 0.0 && values[i] <= 1.0 : std::isfinite(values[i]);
              if (good) continue;
              const std::size_t points = c.array.shape[1];
              return "[" + std::to_string(i / 3 / points) + ", " + std::to_string(i / 3 % points) + ", " +
                     std::to_string(i % 3) + "] is " + FormatDouble(values[i]);
            }
            return std::nullopt;
          }};
}

}  // namespace mocurate::store
