#include "core/formats/c3d.h"

#include <algorithm>
#include <map>

#include "core/base/text.h"
#include "core/formats/line_reader.h"
#include "core/geometry/axes.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {
namespace {

constexpr const char* kUnlabelled[] = {"*", "Unlabeled", "Unlabelled", "Uname"};

/// Points of a subject, or of all where labels have no "SUBJECT:" before them.
struct LabelledPoints {
  std::vector<int> columns;
  std::vector<std::string> names;
};

/// Whether a program gave the point a name because it had none: "", "*3", "Unlabeled_1043".
bool IsUnlabelled(const std::string& label) {
  return label.empty() || std::any_of(std::begin(kUnlabelled), std::end(kUnlabelled),
                                      [&](std::string_view begin) { return label.substr(0, begin.size()) == begin; });
}

/// Positions with a label, by the subject before the label's colon. Labels of programs with four letters may repeat
/// (RKNE, RKNE); the later ones get "_2".
std::map<std::string, LabelledPoints> SubjectsOf(const C3dFile& c3d, RawClip& about) {
  std::map<std::string, LabelledPoints> subjects;
  std::map<std::string, int> seen;
  int unlabelled = 0, outputs = 0;
  std::string repeated;
  for (std::size_t p = 0; p < c3d.points.size(); ++p) {
    const C3dPoint& point = c3d.points[p];
    const std::size_t colon = point.label.find(':');
    std::string name = colon == std::string::npos ? point.label : point.label.substr(colon + 1);
    if (!point.quantity.empty()) {
      ++outputs;
      continue;
    }
    if (IsUnlabelled(name)) {
      ++unlabelled;
      continue;
    }
    if (const int times = ++seen[point.label]; times > 1) {
      name += "_" + std::to_string(times);
      repeated += (repeated.empty() ? "" : ", ") + name + " (" + Shown(point.description) + ")";
    }
    LabelledPoints& subject = subjects[colon == std::string::npos ? "" : point.label.substr(0, colon)];
    subject.columns.push_back(static_cast<int>(p));
    subject.names.push_back(name);
  }
  if (unlabelled > 0) {
    about.remarks.push_back(MakeFinding("unnamed_points", Severity::kInfo, unlabelled,
                                        Counted(unlabelled, "point") + " without a label, left out",
                                        FindingAction::kExcluded));
  }
  if (outputs > 0) about.facts.emplace_back("model_outputs", std::to_string(outputs));
  if (!repeated.empty()) {
    about.remarks.push_back(MakeFinding("label_repeated", Severity::kWarning, 0.0,
                                        "labels that occur again have got a number: " + repeated));
  }
  return subjects;
}

/// The axes by which the file lays the room on a screen: to the right is a person's left who faces it.
std::string AxesOf(const C3dFile& c3d) {
  Matrix3d source_from_canonical = Matrix3d::Zero();
  int column = 0;
  for (const std::string& axis : {c3d.x_screen, c3d.y_screen}) {
    const std::size_t letter = std::string_view("XYZ").find(axis.size() == 2 ? axis[1] : '?');
    if (letter == std::string_view::npos || (axis[0] != '+' && axis[0] != '-')) return "";
    source_from_canonical(static_cast<int>(letter), column++) = axis[0] == '+' ? 1.0 : -1.0;
  }
  source_from_canonical.col(2) = source_from_canonical.col(0).cross(source_from_canonical.col(1));
  if (source_from_canonical.col(2).isZero(0.0)) return "";
  return AxisConvention{source_from_canonical.transpose()}.Text();
}

void TakePoints(const C3dFile& c3d, const LabelledPoints& points, RawClip& clip) {
  clip.frames = c3d.frames;
  clip.joints = static_cast<int>(points.columns.size());
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.confidence.assign(static_cast<std::size_t>(clip.frames) * points.columns.size(), 0.0);
  for (int f = 0; f < clip.frames; ++f) {
    for (int k = 0; k < clip.joints; ++k) {
      const int p = points.columns[static_cast<std::size_t>(k)];
      if (!c3d.seen(f, p)) continue;
      clip.positions.at(f, k) = Eigen::Map<const Vector3d>(c3d.at(f, p));
      clip.confidence[static_cast<std::size_t>(f) * points.columns.size() + static_cast<std::size_t>(k)] = 1.0;
    }
  }
  clip.names = points.names;
  FollowNames(clip);
}

Expected<RawFile> C3dIn(const FileBytes& file) {
  Expected<C3dFile> c3d = ParseC3d(file.bytes, file.name, file.damaged_rows);
  if (!c3d) return Forward(c3d);
  RawClip about;
  about.format = "c3d";
  about.layout_evidence = Counted(static_cast<long long>(c3d->points.size()), "point") + " in " +
                          Counted(c3d->frames, "frame") + ", from frame " + std::to_string(c3d->first_frame);
  about.skeleton.evidence = "points with labels; the file has no skeleton";
  about.units = UnitIn(c3d->units);
  if (c3d->y_screen.size() == 2)
    about.up = std::string(1, c3d->y_screen[0]) + static_cast<char>(c3d->y_screen[1] | 0x20);
  about.handedness = "right";
  about.axes = AxesOf(*c3d);
  if (c3d->rate_hz > 0.0) {
    about.rate_hz = c3d->rate_hz;
    about.rate_evidence = "POINT:RATE";
    about.rate_finding = CheckStatedRate(c3d->rate_hz, RateUnit::kFramesPerSecond, file.name + ": POINT:RATE");
  }
  about.facts.emplace_back("recorded_frames",
                           std::to_string(c3d->first_frame) + "-" + std::to_string(c3d->first_frame + c3d->frames - 1));
  for (Finding& finding : c3d->findings) {
    if (finding.code == "rate_contradiction")
      about.rate_finding = std::move(finding);
    else
      about.remarks.push_back(std::move(finding));
  }
  const std::map<std::string, LabelledPoints> subjects = SubjectsOf(*c3d, about);
  if (subjects.empty()) {
    return Fail(ErrorCode::kInconsistent, "no point is a position with a label", file.name,
                "label the markers, or export joint centres", Reason::kNoValidSamples);
  }
  RawFile raw;
  for (const auto& [subject, points] : subjects) {
    RawClip clip = about;
    if (!subject.empty()) clip.facts.emplace_back("subject", subject);
    if (subjects.size() > 1) clip.id = "[" + (subject.empty() ? "no subject" : subject) + "]";
    TakePoints(*c3d, points, clip);
    raw.clips.push_back(std::move(clip));
  }
  return raw;
}

}  // namespace

FormatDriver C3dFormat() {
  FormatDriver d;
  d.name = "c3d";
  d.kinds = {FileKind::kC3d};
  d.ending = ".c3d";
  d.gives = EvidenceKind::kJointTracks;
  d.states_rate = true;
  d.options = {"markers"};
  d.check = CheckMarkers;
  d.open = C3dIn;
  d.to_clip = TracksAsOpened;
  return d;
}

}  // namespace mocurate
