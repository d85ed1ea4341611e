#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/formats/ntu_skeleton.h"
#include "ingest/folder_listing.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/frame_files.h"
#include "ingest/sources/ntu_people.h"

namespace mocurate {
namespace {

constexpr long long kMostBodiesTogether = 3;

Status CheckViews(const SourceOptions& s) {
  const ViewOptions& views = s.views;
  if (!views.multi_view && !s.first_frame.empty()) {
    return Fail(ErrorCode::kConfig, "files of one camera each have no common first frame", "ingest.source.first_frame",
                "set views: {multi_view: true}, or remove first_frame");
  }
  if (!views.multi_view) {
    if (s.depth_files.empty()) return {};
    return Fail(ErrorCode::kConfig, "depth images need clips that group their views", "ingest.source.depth_files",
                "set views: {multi_view: true}, or remove depth_files");
  }
  if (s.view.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not declare the camera of a file",
                "ingest.source.view", "e.g. view: 'C{camera}'");
  }
  for (const auto& [label, text] : s.bodies) {
    if (ParseInteger(text).value_or(0) <= kMostBodiesTogether) continue;
    return Fail(ErrorCode::kConfig, "label '" + label + "' has '" + text + "' people", "ingest.source.bodies",
                "at most 3 can be matched between several cameras");
  }
  if (s.depth_files.empty()) return {};
  if (views.intrinsics.size() != 4 || views.intrinsics[0] == 0.0 || views.intrinsics[1] == 0.0) {
    return Fail(ErrorCode::kConfig, "the depth images have no intrinsics", "ingest.source.views.intrinsics",
                "four numbers, fx, fy, cx and cy; a Kinect v2 has about [-366, 366, 256, 208] px");
  }
  if (views.image_size.size() != 2) {
    return Fail(ErrorCode::kConfig, "the depth images have no size", "ingest.source.views.image_size",
                "width and height; a Kinect v2 has [512, 424] px");
  }
  return {};
}

Status CheckNtu(const SourceOptions& source) {
  if (Status bodies = CheckBodies(source); !bodies) return bodies;
  if (Status first = CheckFirstFrames(source); !first) return first;
  if (ByBoxes(source.people.rule)) {
    return Fail(ErrorCode::kConfig, "UESTC's rule needs bounding boxes in an image, which ntu_skeleton lacks",
                "ingest.source.people.rule", "motion, official, presence or nearest");
  }
  return CheckViews(source);
}

/// NTU .skeleton -> evidence tracks of one of its people in metres and canonical axes. The sensor's ids identify
/// people. Ids that last at least half as long as the longest come first, ordered by how much they move; people are
/// then listed by first appearance. Ids beyond the number asked for are a finding "bodies_skipped". A person who is
/// asked for and absent is refused.
Expected<IngestedClip> ReadNtuSkeletonClip(const SourceFile& file) {
  if (file.source.views.multi_view) return ReadNtuViewsClip(file);
  const SourceOptions& source = file.source;
  Expected<NtuSkeleton> skeleton = ParseNtuSkeleton(file.bytes, file.name, source.damaged_rows);
  if (!skeleton) return Forward(skeleton);
  const std::size_t wanted = static_cast<std::size_t>(std::max(1, file.named.bodies));
  const Expected<People> people = NtuPeople(*skeleton, source, wanted);
  if (!people) return Forward(people);
  const std::size_t own = static_cast<std::size_t>(std::max(1, file.named.body)) - 1;
  if (own >= people->chosen.size()) {
    return Fail(ErrorCode::kInconsistent,
                "body " + std::to_string(own + 1) + " of " + std::to_string(wanted) + " is not there: the file has " +
                    Counted(people->chosen.size(), "body id") + " in " + Counted(skeleton->frames.size(), "frame"),
                file.name, "the tracker lost the person: remove the file, or correct ingest.source.bodies",
                Reason::kPersonMissing);
  }
  const PersonTrack& body = people->chosen[own];

  IngestedClip ingested;
  ingested.findings = std::move(skeleton->findings);
  ingested.findings.insert(ingested.findings.end(), people->findings.begin(), people->findings.end());
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  const int frames = static_cast<int>(skeleton->frames.size());
  JointTracks tracks;
  tracks.names = NtuJointNames();
  tracks.positions = JointPositions(frames, kNtuJoints);
  tracks.confidence.assign(static_cast<std::size_t>(frames) * kNtuJoints, 0.0);
  for (int f = 0; f < frames; ++f) tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
  bool seen = false;
  for (std::size_t row = 0; row < body.frames.size(); ++row) {
    for (int j = 0; j < kNtuJoints; ++j) {
      if (!body.sees(row, j)) continue;
      seen = true;
      const int f = body.frames[row];
      const double confidence = body.confidence[row * kNtuJoints + static_cast<std::size_t>(j)];
      tracks.confidence[static_cast<std::size_t>(f) * kNtuJoints + static_cast<std::size_t>(j)] = confidence;
      tracks.positions.at(f, j) = body.positions.at(static_cast<int>(row), j);
    }
  }
  if (!seen) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(frames, "frame"), file.name,
                "the tracker lost the person: remove the file", Reason::kNoValidSamples);
  }
  NoteInferredJoints(*skeleton, body, ingested.findings);
  NoteZeroJoints(*skeleton, body, ingested.findings);
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.provenance["body_id"] = body.Name();
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

/// The frames of one body: missing where the sensor does not follow the joint, or the body is not there.
RawClip BodyClip(const NtuSkeleton& skeleton, std::uint64_t id) {
  RawClip clip;
  clip.format = "ntu_skeleton";
  clip.frames = static_cast<int>(skeleton.frames.size());
  clip.joints = kNtuJoints;
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.confidence.assign(static_cast<std::size_t>(clip.frames) * kNtuJoints, 0.0);
  int present = 0;
  for (int f = 0; f < clip.frames; ++f) {
    for (const NtuBody& body : skeleton.frames[static_cast<std::size_t>(f)]) {
      if (body.id != id) continue;
      ++present;
      for (int j = 0; j < kNtuJoints; ++j) {
        const NtuJoint& joint = body.joints[static_cast<std::size_t>(j)];
        if (joint.tracking == 0) continue;
        clip.positions.at(f, j) = Vector3d(joint.x_m, joint.y_m, joint.z_m);
        clip.confidence[static_cast<std::size_t>(f) * kNtuJoints + static_cast<std::size_t>(j)] =
            joint.tracking == 1 ? 0.5 : 1.0;
      }
    }
  }
  clip.facts.emplace_back("body", std::to_string(id));
  clip.layout_evidence = "counts of the file; the body is in " + Counted(present, "frame");
  return clip;
}

Expected<RawFile> NtuIn(const FileBytes& file) {
  const std::string& name = file.name;
  Expected<NtuSkeleton> skeleton = ParseNtuSkeleton(file.bytes, name, DamagedRows::kReport);
  if (!skeleton) {
    Error error = skeleton.error();
    error.code = ErrorCode::kMalformed;  // kInconsistent is for takes without a person
    return tl::unexpected<Error>(std::move(error));
  }
  std::vector<std::uint64_t> ids;
  std::size_t most = 0, fewest = skeleton->frames.empty() ? 0 : skeleton->frames[0].size();
  for (const std::vector<NtuBody>& frame : skeleton->frames) {
    most = std::max(most, frame.size());
    fewest = std::min(fewest, frame.size());
    for (const NtuBody& body : frame) {
      if (std::find(ids.begin(), ids.end(), body.id) == ids.end()) ids.push_back(body.id);
    }
  }
  if (skeleton->frames.empty()) {
    return Fail(ErrorCode::kInconsistent, "the file holds 0 frames", name, "remove the file");
  }
  if (ids.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "no frame of " + std::to_string(skeleton->frames.size()) +
                    " has a body: one of the set's files with missing skeletons",
                name, "remove the file");
  }
  // A clip of a body has all frames of the file.
  if (Status fits = CheckPoseMemory(kNtuJoints * ids.size(), skeleton->frames.size(), file.bytes.size(), name); !fits) {
    return Forward(fits);
  }
  std::vector<RawClip> clips;
  for (const std::uint64_t id : ids) {
    RawClip clip = BodyClip(*skeleton, id);
    NoteInferredJoints(*skeleton, PersonTrack{{id}, {}, {}, {}}, clip.remarks);
    clip.id = ids.size() > 1 ? "[" + std::to_string(clips.size()) + "]" : "";
    clip.people = static_cast<int>(most);
    clip.fewest_people = static_cast<int>(fewest);
    clip.people_evidence = "bodies of the file's frames; " + std::to_string(ids.size()) + " in all";
    clip.rate_evidence = "the file does not state it";
    clip.set_rate_hz = 30.0;
    clip.set_evidence = "the format is of the Kinect v2, which follows people at 30 Hz (Shahroudy et al. 2016)";
    clip.units = "m";
    clip.up = "+y";
    clip.handedness = "right";
    FollowFormat("ntu25", NtuJointNames(), "25 joints of the Kinect v2", clip);
    clips.push_back(std::move(clip));
  }
  clips[0].AddRemarks(skeleton->findings);
  return RawFile::Of(std::move(clips));
}

/// By the name too: too little is left of a file that is cut off behind its counts, or has no body.
bool IsNtu(const FileBytes& file, FileKind kind) {
  const bool counts = file.bytes.find_first_not_of("0123456789 \t\r\n") == std::string_view::npos;
  const bool text = kind == FileKind::kUnknown || (kind == FileKind::kNumbers && counts);
  return text && file.path.extension() == ".skeleton";
}

/// Of NTU RGB+D, 1 to 120.
bool IsNtuActionOfTwo(long long action) { return (action >= 50 && action <= 60) || (action >= 106 && action <= 120); }

/// NTU's names say everything; how many people a file holds is declared per action.
void ProposeNtu(const Proposal& proposal, DeclarationWriter& writer) {
  std::string files = "S{setup:3}C{camera:3}P{person:3}R{repetition:3}A{action:3}.skeleton";
  const Expected<NamePattern> pattern = NamePattern::Parse(files, "files");
  std::set<std::string> folders;  // of files that are named so; the others are not the set's
  for (const std::string& name : proposal.source.files()) {
    const std::string folder = FolderOf(name);
    if (pattern->Match(name.substr(folder.empty() ? 0 : folder.size() + 1))) folders.insert(folder);
  }
  if (folders.empty()) {
    WriteFiles(proposal, writer);
    return WritePersonAndLabel(false, writer);
  }
  int deepest = 0;
  for (const std::string& folder : folders) deepest = std::max(deepest, folder.empty() ? 0 : DepthOf(folder) + 1);
  for (int level = deepest; folders.size() > 1 && level > 0; --level)
    files = "{folder" + std::to_string(level) + "?/}" + files;
  if (folders.size() == 1 && !folders.begin()->empty()) files = *folders.begin() + "/" + files;
  writer.Value("files", YamlQuoted(files), "declared by the format");
  writer.Value("person", "\"P{person}{body}\"", "declared by the format; {body} numbers the people of a file");
  writer.Value("label", "\"A{action}\"", "declared by the format");
  std::set<std::string> of_two, of_one;
  for (const InspectedClip* clip : proposal.source.clips()) {
    const std::string file = clip->file;
    const std::size_t at = file.rfind('A');
    if (at == std::string::npos) continue;
    const std::string action = file.substr(at, 4);
    if (IsNtuActionOfTwo(ParseInteger(action.substr(1)).value_or(0)))
      of_two.insert(action);
    else if (clip->people.value.value_or(0) > 1)
      of_one.insert(action);
  }
  std::string bodies;
  for (const std::string& action : of_two) bodies += (bodies.empty() ? "" : ", ") + action + ": 2";
  if (!bodies.empty()) writer.Value("bodies", "{" + bodies + "}", "known of the set: actions of two people");
  if (of_one.empty()) return;
  writer.Comment("Files of " + JoinTexts({of_one.begin(), of_one.end()}) +
                 " hold several bodies, but the actions have one person: the others are false tracks or bystanders, "
                 "which `people` excludes. `bodies: {" +
                 *of_one.begin() + ": 2}` reads two people.");
}

}  // namespace

FormatDriver NtuSkeletonFormat() {
  FormatDriver d;
  d.name = "ntu_skeleton";
  d.kinds = {FileKind::kNtuSkeleton};
  d.ending = ".skeleton";
  d.gives = EvidenceKind::kJointTracks;
  d.unit = UnitOf::kMetres;
  d.tree = "ntu25";
  d.zeros = "; set to missing";
  d.check = CheckNtu;
  d.options = {"bodies", "people", "views", "first_frame", "inferred_confidence", "depth_files", "depth_unit"};
  d.sniff = IsNtu;
  d.open = NtuIn;
  d.propose = ProposeNtu;
  d.to_clip = ReadNtuSkeletonClip;
  return d;
}

}  // namespace mocurate
