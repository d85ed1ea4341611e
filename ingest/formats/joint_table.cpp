#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include "core/base/problem_list.h"
#include "core/base/text.h"
#include "core/formats/joint_layout.h"
#include "core/formats/number_scanner.h"
#include "core/quality/tracked_points.h"
#include "ingest/formats/driver.h"
#include "ingest/formats/joint_table.h"
#include "ingest/formats/table_header.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/joint_orders.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/options.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr int kFewestTableFrames = 8;  // fewer do not determine the order of joints

void CheckColumns(const SourceOptions& s, ProblemList& problems) {
  const std::vector<std::string> known = {"x",      "y",       "z",       "confidence", "skip",   "frame",
                                          "time_s", "time_ms", "time_us", "time_100ns", "time_ns"};
  for (const std::string& column : s.columns) {
    if (std::find(known.begin(), known.end(), column) != known.end()) continue;
    problems.Add("ingest.source.columns", "unknown column '" + column + "'",
                 "columns are x, y, z, confidence, skip, frame, time_s, time_ms, time_us, time_100ns and time_ns");
  }
  for (const char* needed : {"x", "y", "z"}) {
    if (std::count(s.columns.begin(), s.columns.end(), needed) == 1) continue;
    problems.Add("ingest.source.columns", std::string("column '") + needed + "' must occur exactly once");
  }
}

/// Rows of one frame of a joint table: as declared, else one with `layout` and one per joint with `columns`.
int RowsPerFrame(const SourceOptions& s) {
  if (s.rows_per_frame > 0) return static_cast<int>(s.rows_per_frame);
  return s.layout.empty() ? static_cast<int>(s.joints.size()) : 1;
}

/// The numbers of a frame of a joint table: `layout`, or `columns` for each of the joints. Error kConfig.
Expected<JointLayout> TableLayout(const SourceOptions& s) {
  if (!s.layout.empty()) return ParseJointLayout(s.layout, "ingest.source.layout");
  ProblemList problems;
  CheckColumns(s, problems);
  if (Status known = problems.Result(); !known) return Forward(known);
  std::string words;
  for (const std::string& column : s.columns) words += " " + column;
  return ParseJointLayout(std::to_string(s.joints.size()) + "*(" + words + ")", "ingest.source.columns");
}

/// Whether the last whole frames are a body in the declared order, as the others are. Too few frames count as no body.
bool EndsAsBody(const JointRows& rows, const SourceOptions& source) {
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton || !*skeleton || rows.frames < kFewestTableFrames) return true;
  const std::vector<RawBone> bones = BonesOf(source.joints, **skeleton);
  for (const int frames : {rows.frames, kFewestTableFrames}) {
    JointPositions positions(frames, rows.joints);
    std::vector<double> confidence;
    const std::size_t first = static_cast<std::size_t>(rows.frames - frames) * static_cast<std::size_t>(rows.joints);
    for (std::size_t at = 0; at < positions.xyz.size() / 3; ++at) {
      const Vector3d point(&rows.position[3 * (first + at)]);
      confidence.push_back(point.allFinite() && !point.isZero(0.0) ? 1.0 : 0.0);
      if (confidence.back() > 0.0) std::copy_n(point.data(), 3, &positions.xyz[3 * at]);
    }
    if (!ScoreBody(positions, confidence, bones).IsBody()) return false;
  }
  return true;
}

/// Whether the declaration is that of the file's header, where that names joints.
Status FollowsHeader(const JointRows& rows, const JointLayout& layout, const SourceOptions& source,
                     const std::string& name) {
  if (RowsPerFrame(source) > 1) return {};  // columns of a joint, or of some
  const Expected<std::vector<HeaderColumn>> columns = HeaderColumns(rows.header, layout.NumbersPerFrame(), name);
  return columns ? CheckHeader(*columns, layout, source, name) : Status();  // the declaration decides
}

std::string RowCountProblem(const JointRows& rows, int per_frame) {
  const long long count = static_cast<long long>(rows.frames) * per_frame + rows.rows_left_over;
  const int missing = per_frame - rows.rows_left_over;
  return std::to_string(count) + " rows are not a whole number of frames of " + std::to_string(per_frame) +
         " rows: " + Counted(missing, "row") + (missing == 1 ? " is" : " are") + " missing, or " +
         std::to_string(rows.rows_left_over) + " too many";
}

}  // namespace

Expected<JointRows> ReadTableRows(const SourceOptions& source, std::string_view bytes, const std::string& name) {
  const Expected<std::optional<std::string>> points = WithDecimalPoints(bytes, name);
  if (!points) return Forward(points);
  if (*points) {
    Expected<JointRows> rows = ReadTableRows(source, **points, name);
    if (rows) rows->findings.push_back(DecimalCommas());
    return rows;
  }
  const Expected<JointLayout> layout = TableLayout(source);
  if (!layout) return Forward(layout);
  JointTableLayout table;
  table.rows_per_frame = RowsPerFrame(source);
  table.allow_nan = source.missing == MissingValue::kNan;
  table.damaged_rows = source.damaged_rows;
  table.end_word = source.end_word;
  Expected<JointRows> rows = ParseJointRows(bytes, *layout, table, name, source.rate_hz.value_or(0.0));
  if (!rows) return rows;
  if (Status header = FollowsHeader(*rows, *layout, source, name); !header) return Forward(header);
  if (rows->rows_left_over == 0) return rows;
  // A file that is cut off is a body up to its end; after a lost or repeated row, joints get wrong names.
  if (EndsAsBody(*rows, source)) return rows;
  return Fail(ErrorCode::kInconsistent, RowCountProblem(*rows, table.rows_per_frame), name,
              "the joints stop forming a body before the end of the file: compare the file with its source, or "
              "correct ingest.source.rows_per_frame and joints");
}

namespace {

/// The names of columns and joints, all that are wrong at once.
Status CheckTableNames(const SourceOptions& s) {
  ProblemList problems;
  if (s.layout.empty()) CheckColumns(s, problems);
  const Expected<SkeletonPtr> skeleton = s.skeleton.empty() ? SkeletonPtr() : LoadSkeleton(s.skeleton);
  if (skeleton && *skeleton) CheckJointNames(s, **skeleton, problems);
  return problems.Result();
}

Status CheckTable(const SourceOptions& s) {
  if (s.joints.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not name its joints", "ingest.source.joints",
                "list the joints in the order of the rows of a frame");
  }
  const bool by_columns = s.columns != SourceOptions().columns;
  if (!s.layout.empty() && by_columns) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' declares both `layout` and `columns`",
                "ingest.source.layout", "`layout` includes what `columns` declares; remove one of them");
  }
  if (Status names = CheckTableNames(s); !names) return names;
  const Expected<JointLayout> layout = TableLayout(s);
  if (!layout) return Forward(layout);
  const int joints = static_cast<int>(s.joints.size());
  if (layout->Joints() != joints) {
    return Fail(ErrorCode::kConfig,
                "the layout has " + std::to_string(layout->Joints()) + " joints, " + std::to_string(joints) +
                    " are named under ingest.source.joints",
                "ingest.source.layout", "name each joint of the layout, in its order");
  }
  const int rows = RowsPerFrame(s);
  if (s.layout.empty() && joints % rows != 0) {
    return Fail(ErrorCode::kConfig,
                std::to_string(joints) + " joints do not fill " + std::to_string(rows) + " rows per frame",
                "ingest.source.rows_per_frame", "each row holds the same number of joints");
  }
  if (layout->NumbersPerFrame() % rows != 0) {
    return Fail(ErrorCode::kConfig,
                std::to_string(layout->NumbersPerFrame()) + " numbers of the layout do not fill " +
                    std::to_string(rows) + " rows per frame",
                "ingest.source.rows_per_frame", "each row holds the same count of numbers");
  }
  return {};
}

bool IsMissing(const Vector3d& raw, MissingValue missing) {
  if (!raw.allFinite()) return true;
  return missing == MissingValue::kZero && raw.isZero(0.0);
}

constexpr double kNoRotation = 1e-2;  ///< departure of a written rotation's product with itself from the identity

/// The rotations that the file records, for joints that have one. A rotation that is marked as tracked and is not
/// orthogonal becomes missing, with a finding.
void TakeRotations(const JointRows& rows, const SourceFrame& frame, JointTracks& tracks,
                   std::vector<Finding>& findings) {
  if (rows.rotation.empty()) return;
  tracks.rotation.assign(tracks.confidence.size(), Quaterniond::Identity());
  tracks.rotation_confidence.assign(tracks.confidence.size(), 0.0);
  const Matrix3d turn = frame.world_from_file;
  int malformed = 0;
  int first = 0;
  for (std::size_t at = 0; at < tracks.confidence.size(); ++at) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> written(rows.rotation.data() + 9 * at);
    const double confidence = rows.rotation_confidence.empty() ? 1.0 : rows.rotation_confidence[at];
    if (!(confidence > 0.0) || written.isZero(0.0) || written.hasNaN()) continue;  // NaN is reported with its row
    const bool rotation = written.allFinite() && written.determinant() > 0.0 &&
                          (written.transpose() * written - Matrix3d::Identity()).cwiseAbs().maxCoeff() < kNoRotation;
    if (!rotation) {
      if (malformed++ == 0) first = static_cast<int>(at) / rows.joints;
      continue;
    }
    // A mirrored file mirrors the points' own frames too: which way these lie is the source's convention.
    tracks.rotation[at] = Quaterniond(Matrix3d(turn * written * turn.transpose())).normalized();
    tracks.rotation_confidence[at] = std::min(confidence, 1.0);
  }
  if (malformed == 0) return;
  findings.push_back(FrameFinding(
      "not_a_rotation", first, first + 1, "", malformed,
      Counted(malformed, "recorded rotation") + " marked as tracked: the matrix is not orthogonal; set to missing"));
}

/// Drops the joints that the declaration skips ("-"); returns the names of the others.
std::vector<std::string> TakeNamed(const std::vector<std::string>& joints, JointRows& rows) {
  const auto is_named = [](const std::string& name) { return name != "-"; };
  std::vector<std::string> names;
  std::copy_if(joints.begin(), joints.end(), std::back_inserter(names), is_named);
  if (names.size() == joints.size()) return names;
  const auto take = [&](std::vector<double>& values, std::size_t numbers) {
    std::vector<double> kept;
    for (std::size_t at = 0; at < values.size(); ++at) {
      if (is_named(joints[at / numbers % joints.size()])) kept.push_back(values[at]);
    }
    values = std::move(kept);
  };
  take(rows.position, 3);
  take(rows.confidence, 1);
  take(rows.rotation, 9);
  take(rows.rotation_confidence, 1);
  rows.joints = static_cast<int>(names.size());
  return names;
}

/// The declared rate, or that of the times. Error kInconsistent where they differ, or where neither is there.
Expected<FrameRate> RateOfRows(const SourceFile& file, const JointRows& rows, IngestedClip& ingested) {
  constexpr double kSame = 0.01, kOfAStep = 0.2;  // relative; of one step more or less among those of the file
  const std::optional<double>& declared = file.source.rate_hz;
  if (rows.hz == 0.0) {
    if (declared) return FrameRate::FromHz(*declared);
    return Fail(ErrorCode::kInconsistent, "a table of one time has no rate", file.name, "declare ingest.source.rate");
  }
  const double hz = NearestUsualRate(rows.hz).value_or(rows.hz);
  if (!declared) {
    return RateOfFile(file.source, hz, ingested,
                      CheckStatedRate(hz, RateUnit::kFramesPerSecond, file.name + ": column of times"));
  }
  const double slack = kSame + kOfAStep / std::max(1, rows.frames - 1);
  if (std::abs(rows.hz / *declared - 1.0) <= slack) return FrameRate::FromHz(*declared);
  Error error{ErrorCode::kInconsistent,
              "the times of the rows are of " + RoundedText(rows.hz, 5) + " Hz, the source declares " +
                  RoundedText(*declared, 5) + " Hz",
              file.name,
              "correct ingest.source.rate, or remove it to take that of the times; where these are wrong, correct "
              "their unit in ingest.source.layout, or declare their column as `skip`"};
  error.reason = Reason::kOtherRate;
  error.number = rows.hz;
  return tl::unexpected<Error>(std::move(error));
}

/// Rows of numbers -> evidence tracks in metres and canonical axes. Times lay the frames out (core/formats). A
/// left-handed source is mirrored by its axes only.
Expected<IngestedClip> ReadJointTableClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<SourceFrame> frame = FrameOf(source);
  if (!frame) return Forward(frame);
  Expected<JointRows> rows = ReadTableRows(source, file.bytes, file.name);
  if (!rows) return Forward(rows);

  IngestedClip ingested;
  ingested.findings = std::move(rows->findings);
  const Expected<FrameRate> rate = RateOfRows(file, *rows, ingested);
  if (!rate) return Forward(rate);
  ingested.clip.rate = *rate;
  JointTracks tracks;
  tracks.names = TakeNamed(source.joints, *rows);
  tracks.positions = JointPositions(rows->frames, rows->joints);
  tracks.confidence.assign(static_cast<std::size_t>(rows->frames) * rows->joints, 0.0);
  std::size_t zeros = 0;
  for (int f = 0; f < rows->frames; ++f) {
    tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
    for (int j = 0; j < rows->joints; ++j) {
      const std::size_t at = static_cast<std::size_t>(f) * rows->joints + j;
      const Vector3d raw(rows->position[at * 3], rows->position[at * 3 + 1], rows->position[at * 3 + 2]);
      double confidence = rows->confidence.empty() ? 1.0 : rows->confidence[at];
      if (confidence < 0.0 || confidence > 1.0) {
        return Fail(ErrorCode::kInconsistent,
                    "confidence " + FormatDouble(confidence) + " of joint '" +
                        tracks.names[static_cast<std::size_t>(j)] + "' in frame " + std::to_string(f) +
                        " is not in 0..1",
                    file.name, "declare that column as `skip`, or scale it to 0..1");
      }
      confidence = std::max(confidence, source.least_confidence);
      if (std::isnan(confidence) || IsMissing(raw, source.missing)) confidence = 0.0;
      tracks.confidence[at] = confidence;
      zeros += confidence > 0.0 && raw.isZero(0.0) ? 1 : 0;
      if (confidence > 0.0) tracks.positions.at(f, j) = frame->metres_from_file * raw;
    }
  }
  TakeRotations(*rows, *frame, tracks, ingested.findings);
  if (zeros == tracks.confidence.size()) {
    return Fail(ErrorCode::kInconsistent, "every joint of every frame is 0 0 0: no joint is seen", file.name,
                "the tracker never saw the person: remove the file", Reason::kNoValidSamples);
  }
  const bool any = std::any_of(tracks.confidence.begin(), tracks.confidence.end(), [](double c) { return c > 0.0; });
  if (!any) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(rows->frames, "frame"), file.name,
                "the tracker lost the person: remove the file", Reason::kNoValidSamples);
  }
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

/// The most frequent text of a fact, of those that leave nothing to fill in where there are any, and a clip with it;
/// null where there is none.
std::pair<std::string, const InspectedClip*> UsualFact(const ClipConsensus& source, const char* key) {
  std::map<std::string, std::size_t> counts;
  std::pair<std::string, const InspectedClip*> usual{"", nullptr};
  const auto open = [](const std::string& text) { return text.find(kFillIn) != std::string::npos; };
  for (const InspectedClip* clip : source.clips()) {
    const std::string text = clip->Fact(key);
    if (text.empty()) continue;
    const std::size_t count = ++counts[text];
    const bool better = open(text) == open(usual.first) ? count > counts[usual.first] : !open(text);
    if (usual.second == nullptr || better) usual = {text, clip};
  }
  return usual;
}

void ProposeTable(const Proposal& proposal, DeclarationWriter& writer) {
  const ClipConsensus& source = proposal.source;
  WriteFiles(proposal, writer);
  WritePersonAndLabel(false, writer);
  const auto fact = [&](const char* key) { return UsualFact(source, key).first; };
  for (const char* option : {"layout", "columns"}) {
    const auto [text, clip] = UsualFact(source, option);
    if (clip == nullptr) continue;
    const bool layout = option == std::string("layout");
    const std::size_t open = text.find(kFillIn), z = text.find('z');
    const bool behind = open != std::string::npos && z != std::string::npos && open > z;
    writer.Measured(option, layout ? YamlQuoted(text) : "[" + text + "]", clip->frames.evidence,
                    open == std::string::npos ? ""
                    : behind                  ? "`confidence` or `skip`: nothing says what stands behind x, y, z"
                             : "`frame` where the column counts frames, or its unit where it is a clock: "
                               "time_s, time_ms, time_us, time_100ns, time_ns; the findings have its steps");
    if (!behind) break;
    const auto unsure = std::find_if(source.clips().begin(), source.clips().end(),
                                     [](const InspectedClip* one) { return !one->missing_share.value; });
    if (unsure != source.clips().end()) {
      writer.Comment(
          "least_confidence: 0.1 takes joints of confidence 0 as seen, but doubted; without it they are not seen. " +
          (*unsure)->missing_share.evidence);
    }
    break;
  }
  if (!fact("end_word").empty()) writer.Value("end_word", fact("end_word"), "measured: the last line of some files");
  double missing = 0.0;
  for (const std::string& share : source.Facts("at_origin")) {
    missing = std::max(missing, ParseDouble(share).value_or(0.0));
  }
  if (missing > 0.0) {
    writer.Value("missing", "zero",
                 "measured: up to " + TwoDecimals(100.0 * missing) + " % of a clip's joints are at the origin");
  }
}

}  // namespace

bool HasTimes(const SourceOptions& s) {
  const bool table = s.format == "joint_table" && !(s.layout.empty() && s.joints.empty());
  const Expected<JointLayout> layout = table ? TableLayout(s) : JointLayout();
  return layout && layout->has_time();
}

FormatDriver JointTableFormat() {
  FormatDriver d;
  d.name = "joint_table";
  d.kinds = {FileKind::kNumbers};
  d.gives = EvidenceKind::kJointTracks;
  d.lists_joints = true;
  d.zeros = "; if the tracker writes missing joints so, set ingest.source.missing: zero";
  d.check = CheckTable;
  d.options = {"rows_per_frame", "columns", "layout", "end_word", "least_confidence", "missing"};
  d.open = ReadRawTable;
  d.propose = ProposeTable;
  d.to_clip = ReadJointTableClip;
  return d;
}

}  // namespace mocurate
