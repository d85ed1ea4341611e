#include "core/formats/row_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace mocurate {
namespace {

constexpr double kFar = 0.5;         // of the distance between rows: a joint moves less from frame to frame
constexpr double kMuchNearer = 0.5;  // what another order of joints must come down to
constexpr double kContinues = 0.4;   // mean of a frame's rows, up to which they stand by the joints they should be
constexpr int kFewestRows = 4;       // that tell one order of joints from another
constexpr long long kFewUnexplained = 30;  // frames without continuity, after which nothing is told
constexpr double kScattered = 0.5;         // of the rows far from where they were a frame before: no such frames
constexpr long long kLookedAt = 2000;

/// Walks down the table, with the last place of each joint.
class Follower {
 public:
  Follower(const JointPerRow& table, int joints)
      : table_(table), joints_(joints), last_(static_cast<std::size_t>(joints), -1), apart_(Apart()) {}

  /// A break shows in its own frame alone.
  bool MostRowsGoOn() const {
    double seen = 0.0, far = 0.0;
    const long long step = std::max(1LL, table_.rows / kLookedAt);
    for (long long row = joints_; row < table_.rows; row += step) {
      if (!Seen(row) || !Seen(row - joints_)) continue;
      seen += 1.0;
      far += std::sqrt(Squared(row, row - joints_)) > kFar * apart_ ? 1.0 : 0.0;
    }
    return far <= kScattered * seen;
  }

  std::vector<RowBreak> Run() {
    std::vector<RowBreak> breaks;
    if (!(apart_ > 0.0)) return breaks;
    long long looked_at = -1, unexplained = 0;
    for (long long row = 0; row < table_.rows; ++row) {
      if (Departure(row, joint_) > kFar && AsIs(row).mean() > kContinues) {
        const std::optional<RowBreak> found = BreakAt(row);
        if (!found && row / joints_ != looked_at) {
          looked_at = row / joints_;
          if (++unexplained > kFewUnexplained + table_.rows / joints_ / 10) return {};
        }
        if (found) {
          for (; row < found->row; ++row) Take(row);
          breaks.push_back(*found);
          if (found->missing > 0) {
            joint_ = Joint(found->missing);
          } else {
            row -= found->missing;
          }
        }
      }
      Take(row);
    }
    return breaks;
  }

 private:
  const double* At(long long row) const { return table_.values + row * table_.columns; }

  bool Seen(long long row) const {
    bool any = false;
    for (const int column : table_.xyz) {
      const double value = At(row)[column];
      if (!std::isfinite(value)) return false;
      any = any || value != 0.0;
    }
    return any;
  }

  double Squared(long long a, long long b) const {
    double sum = 0.0;
    for (const int column : table_.xyz) {
      const double difference = At(a)[column] - At(b)[column];
      sum += difference * difference;
    }
    return sum;
  }

  /// Median distance of rows that follow each other: how far joints are apart.
  double Apart() const {
    std::vector<double> distances;
    const long long step = std::max(1LL, table_.rows / kLookedAt);
    for (long long row = 0; row + 1 < table_.rows; row += step) {
      if (Seen(row) && Seen(row + 1)) distances.push_back(std::sqrt(Squared(row, row + 1)));
    }
    if (distances.size() < static_cast<std::size_t>(kFewestRows)) return 0.0;
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
  }

  int Joint(long long ahead) const { return static_cast<int>(((joint_ + ahead) % joints_ + joints_) % joints_); }

  /// How far a row is from the joint's last place, of the distance between joints, 2 at most; negative: nothing tells.
  double Departure(long long row, int joint) const {
    const long long last = last_[static_cast<std::size_t>(joint)];
    if (last < 0 || !Seen(row)) return -1.0;
    return std::min(2.0, std::sqrt(Squared(row, last)) / apart_);
  }

  /// Of the joints from `row` on as they stand up to the split, and after it with `missing` rows less.
  struct Reading {
    double sum = 0.0;
    int told = 0;
    double mean() const { return told > 0 ? sum / told : 2.0; }
  };

  void Add(long long row, int joint, Reading& reading) const {
    if (row >= table_.rows) return;
    const double departure = Departure(row, joint);
    if (departure < 0.0) return;
    reading.sum += departure;
    ++reading.told;
  }

  Reading AsIs(long long row) const {
    Reading reading;
    for (int i = 0; i < joints_; ++i) Add(row + i, Joint(i), reading);
    return reading;
  }

  /// The break that makes the rows of the frame from `row` on continue their joints, near to it.
  std::optional<RowBreak> BreakAt(long long row) const {
    const Reading as_is = AsIs(row);
    if (as_is.told < kFewestRows) return std::nullopt;
    std::optional<RowBreak> best;
    double least = std::min(kMuchNearer * as_is.mean(), kFar);
    const int splits = joints_ / 3 + 1;
    std::vector<Reading> before(static_cast<std::size_t>(splits));
    for (int split = 1; split < splits; ++split) {
      before[static_cast<std::size_t>(split)] = before[static_cast<std::size_t>(split) - 1];
      Add(row + split - 1, Joint(split - 1), before[static_cast<std::size_t>(split)]);
    }
    for (int size = 1; size <= joints_ / 2; ++size) {
      for (const int missing : {size, -size}) {
        const int ahead = std::max(0, missing), extra = std::max(0, -missing);
        Reading after;
        for (int i = joints_ - ahead - 1; i >= 0; --i) {
          Add(row + i + extra, Joint(i + ahead), after);
          if (i >= splits) continue;
          const Reading& first = before[static_cast<std::size_t>(i)];
          const Reading whole{first.sum + after.sum, first.told + after.told};
          const bool earlier = best && best->missing == missing && whole.mean() == least;
          if (whole.told < kFewestRows || (whole.mean() >= least && !earlier)) continue;
          least = whole.mean();
          best = RowBreak{row + i, missing};
        }
      }
    }
    return best;
  }

  void Take(long long row) {
    if (row >= table_.rows) return;
    if (Seen(row)) last_[static_cast<std::size_t>(joint_)] = row;
    joint_ = Joint(1);
  }

  const JointPerRow& table_;
  const int joints_;
  std::vector<long long> last_;
  const double apart_;
  int joint_ = 0;
};

}  // namespace

bool MostRowsGoOn(const JointPerRow& table, int joints_per_frame) {
  return Follower(table, joints_per_frame).MostRowsGoOn();
}

std::vector<RowBreak> FindRowBreaks(const JointPerRow& table, int joints_per_frame) {
  if (joints_per_frame <= kFewestRows || table.rows <= joints_per_frame) return {};
  return Follower(table, joints_per_frame).Run();
}

std::vector<FrameOfRows> FramesOfRows(long long rows, int joints_per_frame, const std::vector<RowBreak>& breaks) {
  std::vector<FrameOfRows> frames;
  FrameOfRows frame;
  int place = 0;  // of the next row in its frame
  const auto pass = [&](int places) {
    for (place += places; place >= joints_per_frame; place -= joints_per_frame) {
      frames.push_back(frame);
      frame = {frame.first + frame.rows, 0};
    }
  };
  auto next = breaks.begin();
  for (long long row = 0; row < rows; ++row) {
    if (next != breaks.end() && next->row == row) {
      if (next->missing > 0) {
        pass(next->missing);
      } else {
        const int extra = -next->missing;
        frame.rows += extra;
        row += extra;
      }
      ++next;
      if (row >= rows) break;
    }
    ++frame.rows;
    pass(1);
  }
  if (frame.rows > 0) frames.push_back(frame);
  return frames;
}

}  // namespace mocurate
