#include <algorithm>
#include <map>
#include <optional>

#include "core/base/text.h"
#include "core/formats/depth_sequence.h"
#include "core/formats/json_place.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/rig_calibration.h"

namespace mocurate {
namespace {

Status CheckDepthFiles(const SourceOptions& source) {
  if (!source.depth_files.empty()) return {};
  return Fail(ErrorCode::kConfig, "source '" + source.name + "' does not declare its depth images",
              "ingest.source.depth_files", "e.g. 'depth/{view}_{frame:4}.png'");
}

Expected<std::map<std::string, FilesOfCamera>> SortFiles(const SourceFile& file) {
  const Expected<NamePattern> pattern = NamePattern::Parse(file.source.depth_files, "ingest.source.depth_files");
  if (!pattern) return Forward(pattern);
  std::map<std::string, FilesOfCamera> views;
  for (const StageInput& input : file.depth_files) {
    const std::optional<NameFields> fields = pattern->Match(input.name);
    if (!fields || fields->count("view") == 0) {
      return Fail(ErrorCode::kConfig, "'" + file.source.depth_files + "' gives no {view} for " + input.name,
                  "ingest.source.depth_files", "e.g. 'depth/{view}_{frame:4}.png'");
    }
    const auto number = fields->find("frame");
    const std::optional<long long> frame = number == fields->end() ? 0 : ParseInteger(number->second);
    if (!frame) continue;
    views[fields->at("view")][*frame] = &input;
  }
  return views;
}

/// Number of the first image over all views: a view that starts later is incomplete.
long long FirstNumber(const DepthSequence& sequence, const std::map<std::string, FilesOfCamera>& views) {
  std::optional<long long> first;
  for (const DepthSequenceView& view : sequence.views) {
    const auto files = views.find(view.name);
    if (files == views.end() || files->second.empty()) continue;
    if (!first || files->second.begin()->first < *first) first = files->second.begin()->first;
  }
  return first.value_or(0);
}

Expected<DepthView> MakeDepthView(const SourceFile& file, const DepthSequence& sequence, const DepthSequenceView& view,
                                  const FilesOfCamera& files, long long first, FrameRate rate,
                                  const RigidTransform& world_from_rig) {
  DepthView made;
  made.camera.name = view.name;
  made.camera.width = view.width;
  made.camera.height = view.height;
  made.camera.fx = view.fx, made.camera.fy = view.fy, made.camera.cx = view.cx, made.camera.cy = view.cy;
  made.camera.camera_from_world = view.camera_from_rig * Inverse(world_from_rig);
  made.metres_per_unit = file.source.depth_unit;
  for (int f = 0; f < sequence.frames; ++f) {
    const auto found = files.find(first + f);
    if (found == files.end()) {
      return Fail(ErrorCode::kNotFound,
                  "view '" + view.name + "' has no depth image for frame " + std::to_string(f) + " of " +
                      std::to_string(sequence.frames) + " (number " + std::to_string(first + f) + ")",
                  file.name, "check ingest.source.depth_files, or complete the folder");
    }
    if (f == 0 && made.camera.width == 0) {
      if (Status sized = SetImageSize(*found->second, made.camera); !sized) return Forward(sized);
    }
    if (Status added = AddDepthImage(*found->second, rate.FrameTime(f), made); !added) return Forward(added);
  }
  return made;
}

/// JSON and depth images -> depth views by reference (file names below the source's folder), cameras in the canonical
/// world, annotated segments.
Expected<IngestedClip> ReadDepthSequenceClip(const SourceFile& file) {
  const Expected<Quaterniond> axes = RotationOfAxes(file.source.axes);
  if (!axes) return Forward(axes);
  const Expected<DepthSequence> sequence = ParseDepthSequence(file.bytes, file.name);
  if (!sequence) return Forward(sequence);
  const auto views = SortFiles(file);
  if (!views) return Forward(views);
  IngestedClip ingested;
  Clip& clip = ingested.clip;
  if (sequence->fps > 0.0)
    clip.rate = RateOfFile(file.source, sequence->fps, ingested);
  else
    clip.rate = {1, 1};  // one moment has no rate
  const RigidTransform world_from_rig{*axes, Vector3d::Zero()};
  const long long first = FirstNumber(*sequence, *views);
  for (const DepthSequenceView& view : sequence->views) {
    const auto files = views->find(view.name);
    Expected<DepthView> made =
        MakeDepthView(file, *sequence, view, files == views->end() ? FilesOfCamera() : files->second, first, clip.rate,
                      world_from_rig);
    if (!made) return Forward(made);
    clip.evidence.depth_views.push_back(std::move(*made));
  }
  for (const DepthSequenceLabel& label : sequence->labels) {
    clip.segments.push_back(
        {clip.rate.FrameTime(label.first), clip.rate.FrameTime(label.last + 1), label.action, "", "annotated"});
  }
  if (!sequence->body.empty()) clip.provenance["body"] = sequence->body;
  if (!sequence->floor.empty()) clip.provenance["floor"] = sequence->floor;
  return ingested;
}

Expected<RawFile> SequenceIn(const FileBytes& file) {
  const auto sequence = ParseDepthSequence(file.bytes, file.name);
  if (!sequence) return Forward(sequence);
  RawClip clip;
  clip.format = "depth_sequence";
  clip.frames = sequence->frames;
  clip.rate_hz = sequence->fps;
  clip.skeleton.evidence = std::to_string(sequence->views.size()) + " depth views, no joints";
  clip.layout_evidence = std::to_string(sequence->views.size()) + " views, " + std::to_string(sequence->labels.size()) +
                         " annotated segments";
  clip.rate_evidence = "fps of the file";
  clip.silence = "depth views, no joints";
  clip.units = "m";
  clip.up = "-y";
  clip.handedness = "right";
  return RawFile::Of(std::move(clip));
}

Expected<RawFile> StillIn(const FileBytes& file) {
  const Expected<nlohmann::json> document = ParseLenientJson(file.bytes, file.name);
  if (!document) return Forward(document);
  const JsonPlace root{&*document, "", &file.name};
  const Expected<JsonPlace> views = root.Key("views");
  if (!views) return Forward(views);
  if (!views->value->is_object() || views->value->empty()) return views->Bad("views by name are expected");
  for (const auto& [view, unused] : views->value->items()) {
    const Expected<JsonPlace> place = views->Key(view);
    if (!place) return Forward(place);
    const Expected<JsonPlace> rotation = place->Key("R_p_to_d");
    if (!rotation) return Forward(rotation);
    if (const auto matrix = rotation->Rotation(); !matrix) return Forward(matrix);
    if (const auto t = VectorAt(*place, "t_m"); !t) return Forward(t);
    if (const auto pinhole = NumbersAt(*place, "fx_fy_cx_cy", 4); !pinhole) return Forward(pinhole);
  }
  RawClip clip;
  clip.format = "depth_still";
  clip.frames = 1;
  const std::string count = std::to_string(views->value->size());
  clip.layout_evidence = count + " depth views of one moment";
  clip.skeleton.evidence = count + " depth views, no joints";
  clip.silence = "depth views, no joints";
  clip.rate_evidence = "one moment has no rate";
  if (root.Has("frame") && (*document)["frame"].is_string()) {
    const std::string frame = (*document)["frame"];
    clip.facts.emplace_back("frame", frame);
    if (frame.find("metres") != std::string::npos) clip.units = "m";
    if (frame.find("x right, y down, z forward") != std::string::npos) {
      clip.up = "-y";
      clip.handedness = "right";
    }
  }
  return RawFile::Of(std::move(clip));
}

void ProposeDepthSequence(const Proposal& proposal, DeclarationWriter& writer) {
  const NamePatternEstimate estimate = WriteFiles(proposal, writer);
  WritePersonAndLabel(false, writer);
  const auto images = EstimateDepthFiles(proposal.folder, proposal.source.files(), estimate.pattern);
  if (images)
    writer.Value("depth_files", YamlQuoted(*images), "what the names of the images have in common");
  else
    writer.Unknown("depth_files", images.error().what);
}

}  // namespace

FormatDriver DepthSequenceFormat() {
  FormatDriver d;
  d.name = "depth_sequence";
  d.gives = EvidenceKind::kDepthViews;
  d.unit = UnitOf::kCalibration;
  d.states_rate = true;
  d.has_truth = true;
  d.check = CheckDepthFiles;
  d.options = {"depth_files", "depth_unit"};
  d.kinds = {FileKind::kDepthSequence, FileKind::kDepthStill};
  d.open = [](const FileBytes& file) {
    return KindOf(file.bytes) == FileKind::kDepthStill ? StillIn(file) : SequenceIn(file);
  };
  d.propose = ProposeDepthSequence;
  d.to_clip = ReadDepthSequenceClip;
  return d;
}

}  // namespace mocurate
