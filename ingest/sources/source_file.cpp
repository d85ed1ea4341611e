#include "ingest/sources/source_file.h"

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/formats/png.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/comparison.h"

namespace mocurate {
namespace {

std::string WithoutEnding(std::string name) {
  const std::size_t dot = name.rfind('.');
  const std::size_t slash = name.rfind('/');
  if (dot != std::string::npos && (slash == std::string::npos || dot > slash + 1) && dot > 0) name.resize(dot);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

constexpr auto kLabelPattern = std::regex::ECMAScript | std::regex::icase;

}  // namespace

std::string IdPart(std::string text) {
  std::replace(text.begin(), text.end(), '/', '.');
  std::replace(text.begin(), text.end(), '#', '.');
  return text;
}

Status CheckLabelRules(const SourceOptions& source) {
  for (const LabelRule& rule : source.label_rules) {
    if (rule.label.empty()) {
      return Fail(ErrorCode::kConfig, "the rule '" + rule.pattern + "' has no label", "ingest.source.label_rules",
                  "add the label of texts that match the pattern");
    }
    try {
      (void)std::regex(rule.pattern, kLabelPattern);
    } catch (const std::regex_error& problem) {
      return Fail(ErrorCode::kConfig, "'" + rule.pattern + "' is not a regular expression: " + problem.what(),
                  "ingest.source.label_rules", "escape literal ( ) [ ] { } . * + ? | with a backslash");
    }
  }
  return {};
}

Expected<std::string> LabelOf(const SourceOptions& source, const std::string& text, const std::string& name) {
  if (source.labels.empty() && source.label_rules.empty()) return text;
  const auto found = source.labels.find(text);
  if (found != source.labels.end()) return found->second;
  if (Status rules = CheckLabelRules(source); !rules) return Forward(rules);
  for (const LabelRule& rule : source.label_rules) {
    if (std::regex_search(text, std::regex(rule.pattern, kLabelPattern))) return rule.label;
  }
  if (source.other_labels == OtherLabels::kKeep) return text;
  std::vector<std::string> known;
  for (const auto& [key, label] : source.labels) known.push_back(key);
  return Fail(ErrorCode::kInconsistent,
              "the label '" + text + "' is not listed under ingest.source.labels" +
                  (source.label_rules.empty() ? "" : ", and no rule of label_rules matches it"),
              name, DidYouMean(text, known, "add it, or repair the file name"));
}

std::string BytesOf(const std::vector<double>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)};
}

/// The fields of a name that do not depend on the camera: "action=001 person=001 repetition=002".
std::string PerformanceOf(const SourceOptions& source, const std::vector<std::string>& names,
                          const NameFields& fields) {
  const std::vector<std::string> of_view = FieldsOf(source.view);
  std::string performance;
  for (const std::string& name : names) {
    if (std::find(of_view.begin(), of_view.end(), name) != of_view.end()) continue;
    const auto value = fields.find(name);
    if (value == fields.end()) continue;
    performance += (performance.empty() ? "" : " ") + name + "=" + value->second;
  }
  return performance;
}

std::string NamedFile::item() const { return identity.source + "/" + identity.person + "/" + identity.recording; }

namespace {

/// What the declaration makes of a name's fields: two ways to read a name that agree in all of it are one.
std::vector<std::string> MadeOf(const SourceOptions& source, NameFields fields) {
  fields.erase("-");
  std::vector<std::string> texts = {
      source.person, source.recording,      source.label,          source.fine_label,  source.session,    source.view,
      source.style,  source.frames_in_name, source.skeleton_files, source.depth_files, source.mask_files, "{camera}",
      "{frame}"};
  texts.insert(texts.end(), source.calibration.begin(), source.calibration.end());
  for (std::string& text : texts) text = FillFields(text, fields);
  return texts;
}

std::string FieldsText(const std::vector<std::string>& names, const NameFields& fields) {
  std::string text;
  for (const std::string& name : names) {
    const auto value = fields.find(name);
    if (value != fields.end()) text += (text.empty() ? "" : ", ") + name + " '" + value->second + "'";
  }
  return text;
}

}  // namespace

std::optional<Error> AmbiguousName(const SourceOptions& source, const NamePattern& pattern, const std::string& name) {
  const std::optional<NameFields> read = pattern.Match(name);
  if (!read) return std::nullopt;
  const std::vector<std::string> made = MadeOf(source, *read);
  const auto listed = [&](const NameFields& fields) {
    return source.labels.count(FillFields(source.label, fields)) != 0;
  };
  const bool meant = listed(*read);
  const std::optional<NameFields> other = pattern.OtherMatch(
      name, [&](const NameFields& fields) { return !(meant && !listed(fields)) && MadeOf(source, fields) != made; });
  if (!other) return std::nullopt;
  std::vector<std::string> names = pattern.FieldNames();
  names.erase(std::remove(names.begin(), names.end(), "-"), names.end());
  std::string width;  // one that leaves the second way only
  for (const std::string& field : names) {
    const auto first = read->find(field), second = other->find(field);
    if (second == other->end() || (first != read->end() && first->second == second->second)) continue;
    width = "{" + field + ":" + std::to_string(second->second.size()) + "}";
  }
  return Error{ErrorCode::kInconsistent,
               "the name fits '" + pattern.text() + "' in two ways: " + FieldsText(names, *read) + "; or " +
                   FieldsText(names, *other),
               name, "give a field its width in ingest.source.files, e.g. " + width + ", or rename the file"};
}

Expected<NamedFile> ReadName(const SourceOptions& source, const std::string& relative_name, int body) {
  const Expected<NamePattern> pattern = NamePattern::Parse(source.files, "ingest.source.files");
  if (!pattern) return Forward(pattern);
  std::optional<NameFields> fields = pattern->Match(relative_name);
  if (!fields) {
    return Fail(ErrorCode::kInconsistent, "the name does not match the pattern '" + source.files + "'", relative_name,
                "rename the file, correct ingest.source.files, or set other_files: ignore");
  }
  NamedFile named;
  named.fields = std::move(*fields);
  named.fields["file"] = WithoutEnding(relative_name);
  named.performer = IdPart(FillFields(source.person, named.fields));
  named.bodies = BodiesOf(source, FillFields(source.label, named.fields));
  named.body = body;
  if (named.bodies > 1) named.fields["body"] = std::string(1, static_cast<char>('a' + body - 1));
  named.identity.source = source.name;
  named.identity.person = IdPart(FillFields(source.person, named.fields));
  if (named.identity.person.empty()) named.identity.person = "unknown";
  named.identity.recording = IdPart(FillFields(source.recording, named.fields));
  if (named.identity.recording.empty()) {
    return Fail(ErrorCode::kConfig, "'" + source.recording + "' gives an empty name for " + relative_name,
                "ingest.source.recording");
  }
  named.identity.session = FillFields(source.session, named.fields);
  named.identity.view = FillFields(source.view, named.fields);
  if (!named.identity.view.empty()) named.performance = PerformanceOf(source, pattern->FieldNames(), named.fields);
  named.identity.licence = source.licence;
  named.style = FillFields(source.style, named.fields);
  const std::string text = FillFields(source.label, named.fields);
  const bool label_elsewhere = text.empty() && (!source.label_table.empty() || !source.container.empty());
  Expected<std::string> label = label_elsewhere ? Expected<std::string>() : LabelOf(source, text, relative_name);
  if (!label) return Forward(label);
  named.label = std::move(*label);
  named.fine_label = FillFields(source.fine_label, named.fields);
  if (const auto fine = source.fine_labels.find(named.fine_label); fine != source.fine_labels.end()) {
    named.fine_label = fine->second;
  }
  const auto role = source.roles.find(named.performer);
  if (role != source.roles.end()) named.role = role->second;
  return named;
}

void CheckJointNames(const SourceOptions& source, const Skeleton& skeleton, ProblemList& problems) {
  std::vector<std::string> known;
  for (const Joint& joint : skeleton.joints) known.push_back(joint.name);
  for (const Landmark& landmark : skeleton.landmarks) known.push_back(landmark.name);
  const char* where = "ingest.source.joints";
  std::set<std::string> listed;
  for (const std::string& name : source.joints) {
    if (name == "-") continue;
    if (!listed.insert(name).second) {
      problems.Add(where, "joint '" + name + "' is listed twice");
      continue;
    }
    if (skeleton.FindJoint(name) || std::find(known.begin(), known.end(), name) != known.end()) continue;
    problems.Add(where, "joint '" + name + "' is unknown to skeleton '" + skeleton.name + "'",
                 [&] { return DidYouMean(name, known, "use the skeleton's names or synonyms"); });
  }
}

Expected<SkeletonPtr> SourceSkeleton(const SourceOptions& source) {
  if (source.skeleton.empty()) return SkeletonPtr();
  Expected<SkeletonPtr> skeleton = LoadSkeleton(source.skeleton);
  if (!skeleton) {
    Error error = skeleton.error();
    if (error.where.empty()) error.where = "ingest.source.skeleton";
    return tl::unexpected<Error>(std::move(error));
  }
  ProblemList problems;
  CheckJointNames(source, **skeleton, problems);
  if (Status known = problems.Result(); !known) return Forward(known);
  return skeleton;
}

Expected<SourceFrame> FrameOf(const SourceOptions& source) {
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  const Expected<double> scale = MetresPerUnit(source.units);
  if (!scale) return Forward(scale);
  return SourceFrame{axes->canonical_from_source, *scale * axes->canonical_from_source};
}

Status SetImageSize(const StageInput& input, Camera& camera) {
  std::string head;
  const Status read = ReadFileInParts(input.path, [&](std::string_view part) {
    head.append(part.substr(0, kPngHeaderBytes - std::min(kPngHeaderBytes, head.size())));
  });
  if (!read) return read;
  const Expected<PngHeader> header = ReadPngHeader(head, input.name);
  if (!header) return Forward(header);
  if (header->bits != 16 || header->channels != 1) {
    return Fail(ErrorCode::kMalformed,
                std::to_string(header->channels) + " channels of " + std::to_string(header->bits) + " bits", input.name,
                "depth images are 16-bit grey PNG");
  }
  camera.width = header->width;
  camera.height = header->height;
  return {};
}

Expected<Quaterniond> RotationOfAxes(const std::string& text) {
  const Expected<AxisConvention> axes = AxisConvention::Parse(text);
  if (!axes) return Forward(axes);
  if (axes->handedness() == Handedness::kLeft) {
    return Fail(ErrorCode::kConfig, "axes '" + text + "' are left-handed", "ingest.source.axes",
                "rotations need a right-handed frame; z up is '+x -z +y', y down '+x -y -z'");
  }
  return Quaterniond(axes->canonical_from_source);
}

Status AddDepthImage(const StageInput& image, double time_s, DepthView& view) {
  std::string hash = image.sha256;
  if (hash.empty()) {
    Expected<std::string> computed = Sha256OfFile(image.path);
    if (!computed) return Forward(computed);
    hash = std::move(*computed);
  }
  view.files.emplace_back(image.name);
  view.sha256.push_back(std::move(hash));
  view.time_s.push_back(time_s);
  return {};
}

FindingAction ContradictionAction(const SourceOptions& source) {
  return source.on_contradiction == OnContradiction::kRefuse ? FindingAction::kRefused : FindingAction::kFlagged;
}

Finding Contradiction(const SourceOptions& source, std::string code, double value, std::string message) {
  return MakeFinding(std::move(code), Severity::kError, value, std::move(message), ContradictionAction(source));
}

FrameRate RateOfFile(const SourceOptions& source, double file_hz, IngestedClip& ingested,
                     std::optional<Finding> rate_finding) {
  if (!source.rate_hz && rate_finding) {
    rate_finding->action = FindingAction::kRefused;
    ingested.findings.push_back(*std::move(rate_finding));
  }
  if (!source.rate_hz) return FrameRate::FromHz(file_hz);
  const std::optional<Finding> differs = CompareRate(source, file_hz);
  ingested.shown["rate_contradiction"] = {differs.has_value(), 1.0};
  if (differs) {
    ingested.findings.push_back(
        Contradiction(source, differs->code, differs->value,
                      differs->message + "; correct ingest.source.rate, or remove it where the files are right"));
  }
  return FrameRate::FromHz(*source.rate_hz);
}

void NoteEmptyFrames(const JointTracks& tracks, std::vector<Finding>& findings) {
  NoteEmptyFrames(tracks.confidence, tracks.positions.frames, findings);
}

void NoteEmptyFrames(const std::vector<double>& confidence, int frames, std::vector<Finding>& findings) {
  if (frames <= 0 || confidence.empty()) return;
  const auto joints = static_cast<std::ptrdiff_t>(confidence.size()) / frames;
  const auto empty = [&](int f) {
    const auto first = confidence.begin() + f * joints;
    return std::all_of(first, first + joints, [](double c) { return c == 0.0; });
  };
  // Frames whose rows were damaged are reported already.
  std::vector<char> reported(static_cast<std::size_t>(frames), 0);
  for (const Finding& finding : findings) {
    if (finding.action != FindingAction::kDropped) continue;
    for (int f = std::max(0, finding.frame_begin); f < std::min(frames, finding.frame_end); ++f)
      reported[static_cast<std::size_t>(f)] = 1;
  }
  for (int f = 0; f < frames; ++f) {
    if (!empty(f) || reported[static_cast<std::size_t>(f)] != 0) continue;
    const int begin = f;
    while (f < frames && empty(f) && reported[static_cast<std::size_t>(f)] == 0) ++f;
    findings.push_back(
        FrameFinding("no_joint_seen", begin, f, "", f - begin,
                     "no joint is seen in " + std::to_string(f - begin) + " of " + Counted(frames, "frame")));
    findings.back().action = FindingAction::kMissing;
  }
}

}  // namespace mocurate
