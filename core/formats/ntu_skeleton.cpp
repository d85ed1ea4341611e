#include "core/formats/ntu_skeleton.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/formats/line_reader.h"
#include "core/formats/number_scanner.h"

namespace mocurate {
namespace {

using Token = NumberScanner::Token;

constexpr std::array<const char*, 10> kBodyFields = {"body id",
                                                     "clipped edges",
                                                     "left hand confidence",
                                                     "left hand state",
                                                     "right hand confidence",
                                                     "right hand state",
                                                     "restricted",
                                                     "lean x",
                                                     "lean y",
                                                     "body tracking state"};
constexpr std::array<const char*, 12> kJointFields = {"x",        "y",  "z",  "depth u", "depth v", "colour u",
                                                      "colour v", "qw", "qx", "qy",      "qz",      "tracking state"};
constexpr int kMostBodies = 1000;  // the sensor follows six; bounds a damaged count
constexpr int kTracked = 2;

class NtuParser {
 public:
  NtuParser(std::string_view bytes, const std::string& name, DamagedRows damaged_rows)
      : scanner_(bytes, false), bytes_(bytes.size()), name_(name), reports_(damaged_rows == DamagedRows::kReport) {}

  Expected<NtuSkeleton> Run() {
    const Expected<int> frames = Count("frame count", std::numeric_limits<int>::max());
    if (!frames) return Forward(frames);
    const int line = line_;
    for (frame_ = 0; !AtEnd(); ++frame_) {
      body_ = -1;
      const Expected<int> bodies = Count("body count", kMostBodies);
      if (!bodies) return Forward(bodies);
      skeleton_.frames.emplace_back();
      Status read;
      for (body_ = 0; read && body_ < *bodies; ++body_) read = Body();
      if (read) continue;
      if (!reports_ || frame_ == 0 || !AtEnd()) return Forward(read);
      DropLastFrame(read.error());
      break;
    }
    frame_ = body_ = joint_ = -1;
    if (Status fits = CheckPoseMemory(kNtuJoints, skeleton_.frames.size(), bytes_, name_); !fits) return Forward(fits);
    if (const int found = static_cast<int>(skeleton_.frames.size()); found != *frames) {
      const auto contradiction =
          CountContradiction("the frame count", *frames, found, name_ + ":" + std::to_string(line));
      if (!reports_) return contradiction;
      Report("count_contradiction", *frames, line, contradiction.value().what);
      skeleton_.findings.back().severity = Severity::kError;
      skeleton_.findings.back().frame_end = 0;
      skeleton_.findings.back().action = FindingAction::kKept;
    }
    return std::move(skeleton_);
  }

 private:
  tl::unexpected<Error> Bad(const std::string& what, ErrorCode code = ErrorCode::kMalformed,
                            const std::string& hint = "copy the file again", int line = 0) const {
    return Fail(code, what + Where(), name_ + ":" + std::to_string(line > 0 ? line : scanner_.line()), hint);
  }

  bool AtEnd() const {
    NumberScanner ahead = scanner_;
    Token token = ahead.Next();
    while (token == Token::kLineEnd) token = ahead.Next();
    return token == Token::kEnd;
  }

  void Report(const char* code, double value, int line, const std::string& what) {
    constexpr std::size_t kMostFindings = 1000;
    if (skeleton_.findings.size() >= kMostFindings) return;
    const int begin = std::max(frame_, 0);
    skeleton_.findings.push_back(FindingOfFrames(code, begin, begin + 1, value,
                                                 name_ + ":" + std::to_string(line) + ": " + what + Where(),
                                                 FindingAction::kDropped));
    if (joint_ >= 0) skeleton_.findings.back().joint = std::to_string(joint_);
  }

  /// Drops the frame in which the file ends; one finding replaces those of its lines.
  void DropLastFrame(const Error& why) {
    std::vector<Finding>& findings = skeleton_.findings;
    findings.erase(std::remove_if(findings.begin(), findings.end(),
                                  [&](const Finding& finding) { return finding.frame_begin == frame_; }),
                   findings.end());
    skeleton_.frames.pop_back();
    const int frame = std::exchange(frame_, -1);
    body_ = joint_ = -1;
    Report("cut_off", frame, scanner_.line(), "the file is cut off: " + why.what);
    findings.back().severity = Severity::kError;
    findings.back().frame_begin = frame;
    findings.back().frame_end = frame + 1;
  }

  std::string Where() const {
    if (frame_ < 0) return "";
    std::string where = ", frame " + std::to_string(frame_);
    if (body_ >= 0) where += ", body " + std::to_string(body_);
    if (joint_ >= 0) where += ", joint " + std::to_string(joint_);
    return where;
  }

  /// Numbers of the next line that is not blank, into `row_`; `line_` is its line number. Where a damaged line may
  /// be skipped (`damaged` is not null), `damaged` returns whether it was.
  Status Row(const char* const* fields, int count, bool* damaged = nullptr) {
    row_.clear();
    Token token = Token::kLineEnd;
    while (row_.empty() && token == Token::kLineEnd) {
      line_ = scanner_.line();
      token = scanner_.Numbers(row_);
    }
    const int read = static_cast<int>(row_.size());
    const bool skips = reports_ && damaged != nullptr;
    if (token == Token::kWord || token == Token::kNotFinite) {
      const std::string what = "'" + Shown(scanner_.text()) +
                               "' is not a finite number: " + (read < count ? fields[read] : "after the last field");
      if (!skips) return Bad(what);
      Report("not_a_number", read, line_, what);
      while (token != Token::kLineEnd && token != Token::kEnd) token = scanner_.Next();
      *damaged = true;
      return {};
    }
    for (int i = 0; i < std::min(read, count); ++i) {
      if (std::abs(row_[static_cast<std::size_t>(i)]) <= kLargestNumber) continue;
      const std::string what =
          FormatDouble(row_[static_cast<std::size_t>(i)]) + " is not a plausible value: " + fields[i];
      if (!skips)
        return Bad(what, ErrorCode::kMalformed, "the largest allowed number is " + FormatDouble(kLargestNumber), line_);
      Report("number_too_large", i, line_, what);
      *damaged = true;
      return {};
    }
    if (read == 0) {
      return Bad(std::string("the file ends where the ") + fields[0] + " is expected", ErrorCode::kInconsistent,
                 "a count contradicts what follows, or the file is cut off: copy it again");
    }
    if (read == count) return {};
    const std::string what = std::to_string(read) + " numbers are found where " + std::to_string(count) +
                             " are expected, from " + fields[0] +
                             (count > 1 ? std::string(" to ") + fields[count - 1] : "");
    // A line of one number or of ten may be a count or another body: then lines are missing, and nothing has its place.
    if (skips && read != 1 && read != static_cast<int>(kBodyFields.size())) {
      Report("row_length", read, line_, what);
      *damaged = true;
      return {};
    }
    return Bad(what, ErrorCode::kInconsistent, "a count contradicts what follows, or the line is damaged", line_);
  }

  Expected<int> Whole(double value, const char* field, int least, int most) const {
    if (!(value >= least && value <= most) || value != std::floor(value)) {
      return Bad(std::string(field) + " " + FormatDouble(value) + " is not a whole number from " +
                     std::to_string(least) + " to " + std::to_string(most),
                 ErrorCode::kMalformed, "copy the file again", line_);
    }
    return static_cast<int>(value);
  }

  Expected<int> Count(const char* field, int most) {
    if (Status row = Row(&field, 1); !row) return Forward(row);
    return Whole(row_[0], field, 0, most);
  }

  Status BodyId(std::uint64_t& id) {
    Token token = scanner_.Next();
    while (token == Token::kLineEnd) token = scanner_.Next();
    if (token == Token::kEnd) {
      return Bad("the file ends where a body id is expected", ErrorCode::kInconsistent,
                 "a count contradicts what follows, or the file is cut off: copy it again");
    }
    const std::string_view text = scanner_.text();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
    if (error != std::errc() || end != text.data() + text.size()) {
      return Bad("'" + Shown(text) + "' is not a body id", ErrorCode::kMalformed, "a whole number of up to 64 bits");
    }
    for (const NtuBody& other : skeleton_.frames.back()) {
      if (other.id == id) return Bad("body id " + std::to_string(id) + " appears twice in a frame");
    }
    return {};
  }

  Status Body() {
    joint_ = -1;
    NtuBody body;
    if (Status id = BodyId(body.id); !id) return id;
    const int line = scanner_.line();
    bool damaged = false;
    if (Status row = Row(&kBodyFields[1], 9, &damaged); !row) return row;
    if (line_ != line) {
      return Bad("1 number is found where 10 are expected, from body id to body tracking state",
                 ErrorCode::kInconsistent, "a count contradicts what follows, or the line is damaged", line);
    }
    const Expected<int> joints = Count("joint count", std::numeric_limits<int>::max());
    if (!joints) return Forward(joints);
    if (*joints != kNtuJoints) {
      return Bad("joint count " + std::to_string(*joints) + " is not 25", ErrorCode::kInconsistent,
                 "a count contradicts what follows, or the line is damaged", line_);
    }
    for (joint_ = 0; joint_ < kNtuJoints; ++joint_) {
      if (Status joint = Joint(body.joints[static_cast<std::size_t>(joint_)]); !joint) return joint;
    }
    joint_ = -1;
    skeleton_.frames.back().push_back(body);
    return {};
  }

  Status Joint(NtuJoint& joint) {
    bool damaged = false;
    if (Status row = Row(kJointFields.data(), 12, &damaged); !row) return row;
    if (damaged) return {};  // zeros, not tracked
    const double* v = row_.data();
    joint = {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10], 0};
    const Expected<int> tracking = Whole(v[11], kJointFields[11], 0, kTracked);
    if (!tracking) return Forward(tracking);
    joint.tracking = *tracking;
    return {};
  }

  NumberScanner scanner_;
  std::size_t bytes_;
  const std::string& name_;
  bool reports_;
  NtuSkeleton skeleton_;
  std::vector<double> row_;
  int line_ = 1;
  int frame_ = -1, body_ = -1, joint_ = -1;
};

void AppendWord(std::string& text, double value) {
  text += FormatDouble(value);
  text += ' ';
}

std::string ThreeDigits(char letter, int number) { return letter + ZeroPadded(number, 3); }

}  // namespace

Expected<NtuSkeleton> ParseNtuSkeleton(std::string_view bytes, const std::string& name, DamagedRows damaged_rows) {
  return NtuParser(bytes, name, damaged_rows).Run();
}

std::string WriteNtuSkeleton(const NtuSkeleton& skeleton) {
  std::string text = std::to_string(skeleton.frames.size()) + "\n";
  for (const std::vector<NtuBody>& frame : skeleton.frames) {
    text += std::to_string(frame.size()) + "\n";
    for (const NtuBody& body : frame) {
      text += std::to_string(body.id) + " 0 0 1 0 1 0 0 0 2\n25\n";  // open hands, not clipped, tracked
      for (const NtuJoint& j : body.joints) {
        for (const double value :
             {j.x_m, j.y_m, j.z_m, j.depth_u, j.depth_v, j.colour_u, j.colour_v, j.qw, j.qx, j.qy, j.qz}) {
          AppendWord(text, value);
        }
        text += std::to_string(j.tracking) + "\n";
      }
    }
  }
  return text;
}

std::string NtuName::Text() const {
  return ThreeDigits('S', setup) + ThreeDigits('C', camera) + ThreeDigits('P', performer) +
         ThreeDigits('R', replication) + ThreeDigits('A', action);
}

int FirstSetupOf(int action) { return action > kLastNtu60Action ? kLastNtu60Setup + 1 : 1; }

}  // namespace mocurate
