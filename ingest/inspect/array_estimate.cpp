#include "ingest/inspect/array_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/joint_orders.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestArrayFrames = 8;  // fewer tell no spread of lengths
constexpr std::size_t kFewestArrayJoints = 10, kMostArrayJoints = 200;
constexpr double kClearlyRigid = 0.5 * kRigid;

/// Axes of the array that are frames, joints and coordinates.
using Axes = std::array<std::size_t, 3>;
constexpr Axes kAsItLies = {0, 1, 2};
constexpr Axes kExchanged[] = {{1, 0, 2}, {0, 2, 1}, {2, 0, 1}, {1, 2, 0}, {2, 1, 0}};

bool Possible(const NpyArray& array, const Axes& axes) {
  const std::size_t frames = array.shape[axes[0]], joints = array.shape[axes[1]];
  return array.shape[axes[2]] == 3 && frames >= kFewestArrayFrames && joints >= kFewestArrayJoints &&
         joints <= kMostArrayJoints;
}

struct Points {
  JointPositions positions;
  std::vector<double> confidence;
};

Points ReadPoints(const NpyArray& array, const Axes& axes) {
  const std::array<std::size_t, 3> stride = {array.shape[1] * array.shape[2], array.shape[2], 1};
  const auto frames = static_cast<int>(array.shape[axes[0]]), joints = static_cast<int>(array.shape[axes[1]]);
  Points points{JointPositions(frames, joints), {}};
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < joints; ++j) {
      Vector3d at;
      for (int c = 0; c < 3; ++c) {
        at[c] =
            array.values[static_cast<std::size_t>(f) * stride[axes[0]] + static_cast<std::size_t>(j) * stride[axes[1]] +
                         static_cast<std::size_t>(c) * stride[axes[2]]];
      }
      const bool seen = at.allFinite() && at.cwiseAbs().maxCoeff() <= kLargestNumber;
      points.confidence.push_back(seen ? 1.0 : 0.0);
      if (seen) points.positions.at(f, j) = at;
    }
  }
  return points;
}

/// The known order in which they are a body; nothing where there is none.
std::optional<std::string> BodyIn(const Points& points) {
  const std::vector<OrderScore> scores = ScoreOrders(points.positions, points.confidence);
  if (scores.empty() || !scores[0].score.IsBody()) return std::nullopt;
  return scores[0].order->name;
}

std::string ShapeOfAxes(const Axes& axes) {
  std::array<std::string, 3> names;
  names[axes[0]] = "frames";
  names[axes[1]] = "joints";
  names[axes[2]] = "3";
  return "(" + names[0] + ", " + names[1] + ", " + names[2] + ")";
}

}  // namespace

std::optional<AxisOrder> ExchangedAxes(const NpyArray& array, std::size_t joints) {
  if (array.shape.size() != 3 || array.values.empty()) return std::nullopt;
  if (std::none_of(std::begin(kExchanged), std::end(kExchanged),
                   [&](const Axes& axes) { return Possible(array, axes); }))
    return std::nullopt;
  bool loose = true;  // no two points keep their distance as they lie
  if (array.shape[2] == 3) {
    if (joints > 0 && array.shape[1] == joints) return std::nullopt;
    const Points points = ReadPoints(array, kAsItLies);
    if (BodyIn(points)) return std::nullopt;
    loose = Rigidity(points.positions, points.confidence) > kRigid;
  }
  // A body says more than distances that are kept: frames that follow each other keep some too.
  std::optional<AxisOrder> likeliest;
  double least = kClearlyRigid;
  for (const Axes& axes : kExchanged) {
    if (!Possible(array, axes) || (joints > 0 && array.shape[axes[1]] != joints)) continue;
    const Points points = ReadPoints(array, axes);
    const std::optional<std::string> body = BodyIn(points);
    const double rigidity = body || !loose ? kClearlyRigid : Rigidity(points.positions, points.confidence);
    const bool rigid = rigidity < least;
    const bool declared = joints > 0 && !likeliest;
    if (!body && !rigid && !declared) continue;
    AxisOrder order;
    order.words = "its axes are " + ShapeOfAxes(axes) + ", not (frames, joints, 3): so " +
                  (body    ? "the points are a body in the order '" + *body + "', as they lie they are none"
                   : rigid ? "the points keep their distances, as they lie they do not"
                           : "it has the " + std::to_string(joints) + " joints that are declared");
    order.way_out = "write it with numpy's transpose(" + std::to_string(axes[0]) + ", " + std::to_string(axes[1]) +
                    ", " + std::to_string(axes[2]) + ")";
    if (body) return order;
    if (rigid) least = rigidity;
    likeliest = std::move(order);
  }
  return likeliest;
}

DamagedNumbers DamagedNumbersOf(const double* xyz, int frames, int joints, const std::string& name) {
  struct Tally {
    long long numbers = 0;
    int frames = 0, first = 0, last = 0;
    std::string place;
  };
  Tally not_finite, too_large;
  DamagedNumbers damaged;
  const std::ptrdiff_t wide = static_cast<std::ptrdiff_t>(joints) * 3;
  for (int f = 0; f < frames; ++f) {
    const double* row = xyz + f * wide;
    for (std::ptrdiff_t at = 0; at < wide; ++at) {
      const double value = row[at];
      if (std::isfinite(value) && std::abs(value) <= kLargestNumber) continue;
      Tally& tally = std::isfinite(value) ? too_large : not_finite;
      if (tally.numbers++ == 0) {
        tally.first = f;
        tally.place = "frame " + std::to_string(f) + ", joint " + std::to_string(at / 3) + ", " + "xyz"[at % 3] + ": " +
                      (std::isnan(value) ? "NaN" : FormatDouble(value));
      }
      if (tally.frames == 0 || tally.last != f) ++tally.frames;
      tally.last = f;
      if (damaged.frames.empty() || damaged.frames.back() != f) damaged.frames.push_back(f);
    }
  }
  const auto tell = [&](const char* code, const Tally& tally, const char* one, const char* many) {
    if (tally.numbers == 0) return;
    Finding finding =
        FrameFinding(code, tally.first, tally.last + 1, "", static_cast<double>(tally.numbers),
                     name + ": " + Counted(tally.numbers, "number") + " in " + std::to_string(tally.frames) + " of " +
                         Counted(frames, "frame") + (tally.numbers == 1 ? one : many) +
                         (tally.numbers == 1 ? ", in " : ", the first in ") + tally.place);
    finding.action = FindingAction::kDropped;
    damaged.findings.push_back(std::move(finding));
  };
  tell("not_a_number", not_finite, " is not finite", " are not finite");
  tell("number_too_large", too_large, " is no coordinate of a person", " are no coordinates of a person");
  return damaged;
}

tl::unexpected<Error> NoValidSamples(std::size_t numbers, const std::string& name) {
  return Fail(ErrorCode::kMalformed,
              "all " + std::to_string(numbers) + " numbers are NaN or infinite, or beyond any person: no joint is seen",
              name, "leave the file out", Reason::kNoValidSamples);
}

}  // namespace mocurate
