#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <tuple>

#include "core/base/text.h"
#include "core/formats/camera_files.h"
#include "core/formats/png.h"
#include "core/quality/tracked_points.h"
#include "ingest/checks/keypoint_checks.h"
#include "ingest/inspect/clip_report.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/frame_files.h"

namespace mocurate {
namespace {

/// The usual number of points of people who have any; 0: none has.
std::size_t UsualPoints(const std::vector<OpenPoseFrame>& frames) {
  std::map<std::size_t, std::size_t> people;
  for (const OpenPoseFrame& frame : frames) {
    for (const OpenPosePerson& person : frame.people) {
      if (!person.pose.empty()) people[person.pose.size()] += 1;
    }
  }
  const auto usual =
      std::max_element(people.begin(), people.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return usual == people.end() ? 0 : usual->first;
}

/// Keypoints of a folder's images; `everybody`: of all folders with the same detector, for the layout.
RawClip ReadRawKeypoints(const std::vector<OpenPoseFrame>& frames, const std::vector<OpenPosePerson>& everybody) {
  RawClip clip;
  clip.format = "openpose";
  clip.frames = static_cast<int>(frames.size());
  std::size_t most = 0, fewest = frames.empty() ? 0 : frames[0].people.size();
  const std::size_t joints = UsualPoints(frames);
  std::size_t points = 0, missing = 0, without = 0, odd = 0;
  for (const OpenPoseFrame& frame : frames) {
    most = std::max(most, frame.people.size());
    fewest = std::min(fewest, frame.people.size());
    for (const OpenPosePerson& person : frame.people) {
      without += person.pose.empty() ? 1 : 0;
      odd += !person.pose.empty() && person.pose.size() != joints ? 1 : 0;
      for (const DetectedKeypoint& point : person.pose) {
        ++points;
        missing += point.detected() ? 0 : 1;
      }
    }
  }
  clip.joints = static_cast<int>(joints);
  clip.people = static_cast<int>(most);
  clip.fewest_people = static_cast<int>(fewest);
  clip.people_evidence = "entries of the files, one a frame; bystanders count as well";
  clip.layout_evidence = "one file a frame";
  clip.units = "px";
  clip.silence = "keypoints of one image: no depth";
  clip.rate_evidence = "the files do not declare it";
  if (points > 0) clip.missing_share = static_cast<double>(missing) / static_cast<double>(points);
  clip.skeleton = MeasuredText(EstimateKeypointLayout(everybody));
  std::vector<OpenPosePerson> here;
  for (const OpenPoseFrame& frame : frames) here.insert(here.end(), frame.people.begin(), frame.people.end());
  for (const Finding& doubt : CheckKeypointNumbers(here)) clip.remarks.push_back(doubt);
  if (odd > 0) {
    clip.remarks.push_back(MakeFinding("keypoint_count", Severity::kWarning, static_cast<double>(odd),
                                       std::to_string(odd) + (odd == 1 ? " person has" : " people have") +
                                           " another number of keypoints than " + std::to_string(joints) +
                                           ": a run takes them as not seen"));
  }
  if (without > 0) {
    clip.remarks.push_back(MakeFinding("empty_person", Severity::kInfo, static_cast<double>(without),
                                       std::to_string(without) + " entries of people hold no keypoints"));
  }
  return clip;
}

/// A clip per body of a scene.
std::vector<RawClip> ReadRawPanoptic(const std::vector<PanopticBodies>& scenes) {
  std::vector<int> ids;
  std::size_t most = 0, fewest = scenes.empty() ? 0 : scenes[0].bodies.size(), joints = 0;
  for (const PanopticBodies& scene : scenes) {
    most = std::max(most, scene.bodies.size());
    fewest = std::min(fewest, scene.bodies.size());
    for (const PanopticBody& body : scene.bodies) {
      joints = std::max(joints, body.position_cm.size());
      if (std::find(ids.begin(), ids.end(), body.id) == ids.end()) ids.push_back(body.id);
    }
  }
  std::vector<RawClip> clips;
  for (const int id : ids) {
    RawClip clip;
    clip.id = ids.size() > 1 ? "[" + std::to_string(clips.size()) + "]" : "";
    clip.format = "panoptic_bodies";
    clip.frames = static_cast<int>(scenes.size());
    clip.joints = static_cast<int>(joints);
    clip.people = static_cast<int>(most);
    clip.fewest_people = static_cast<int>(fewest);
    clip.people_evidence = "bodies of the files, one a frame";
    clip.layout_evidence = "one file a frame";
    clip.facts.emplace_back("body", std::to_string(id));
    clip.positions = JointPositions(clip.frames, clip.joints);
    clip.confidence.assign(static_cast<std::size_t>(clip.frames) * joints, 0.0);
    for (std::size_t f = 0; f < scenes.size(); ++f) {
      for (const PanopticBody& body : scenes[f].bodies) {
        for (std::size_t j = 0; body.id == id && j < body.position_cm.size(); ++j) {
          if (body.confidence[j] < 0.0) continue;
          clip.positions.at(static_cast<int>(f), static_cast<int>(j)) = body.position_cm[j];
          clip.confidence[f * joints + j] = std::max(1e-6, body.confidence[j]);
        }
      }
    }
    if (const double rate_hz = RateByClock(scenes); rate_hz > 0.0) {
      clip.rate_hz = std::round(100.0 * rate_hz) / 100.0;
      clip.rate_evidence = "univTime of the files, " + scenes.front().fps_type;
    }
    clip.units = "cm";
    clip.names.assign(PanopticJointNames().begin(), PanopticJointNames().begin() + static_cast<std::ptrdiff_t>(joints));
    clip.skeleton = AsDeclared(joints == 19 ? "coco19" : "coco15", "joints19 or joints15 of the file");
    clip.points = FindHandednessPoints([&](std::string_view name) -> std::optional<int> {
      const std::string wanted = name == "head" ? "nose" : std::string(name);
      const auto at = std::find(clip.names.begin(), clip.names.end(), wanted);
      if (at == clip.names.end()) return std::nullopt;
      return static_cast<int>(at - clip.names.begin());
    });
    clips.push_back(std::move(clip));
  }
  return clips;
}

/// The name with '#' for its last number, and the number.
std::optional<std::pair<std::string, long long>> Numbered(const std::string& name) {
  constexpr const char* kDigits = "0123456789";
  const std::size_t slash = name.rfind('/') + 1;  // 0 without one
  const std::size_t last = name.find_last_of(kDigits);
  if (last == std::string::npos || last < slash) return std::nullopt;
  const std::size_t before = name.find_last_not_of(kDigits, last);
  const std::size_t begin = std::max(slash, before == std::string::npos ? 0 : before + 1);
  const auto number = ParseInteger(name.substr(begin, last + 1 - begin));
  if (!number) return std::nullopt;
  return std::pair(name.substr(0, begin) + '#' + name.substr(last + 1), static_cast<long long>(*number));
}

}  // namespace

Status RawSequences::AddOpenPose(const FileBytes& file) {
  Expected<OpenPoseFrame> frame = ParseOpenPose(file.bytes, file.name);
  if (!frame) return Forward(frame);
  Folder& folder = folders_[FolderOf(file.name)];
  folder.unseen.Add(*frame, file.name);
  folder.frames.Add(file.name);
  folder.keypoints.push_back(std::move(*frame));
  folder.keypoint_files.push_back(file.name);
  return {};
}

Status RawSequences::AddPanoptic(const FileBytes& file) {
  Expected<PanopticBodies> scene = ParsePanopticBodies(file.bytes, file.name);
  if (!scene) return Forward(scene);
  Folder& folder = folders_[FolderOf(file.name)];
  folder.scenes.push_back(std::move(*scene));
  folder.frames.Add(file.name);
  return {};
}

bool RawSequences::Claim(const std::string& name, const Error& error) {
  const auto folder = folders_.find(FolderOf(name));
  return folder != folders_.end() && folder->second.frames.AddBroken(name, error);
}

/// Views of one recording stand in folders side by side.
std::vector<const FrameNames*> RawSequences::FramesBeside(const std::string& name) const {
  std::vector<const FrameNames*> beside;
  for (const auto& [other, folder] : folders_) {
    if (other != name && FolderOf(other) == FolderOf(name) && !folder.keypoints.empty())
      beside.push_back(&folder.frames);
  }
  return beside;
}

std::map<std::string, std::vector<Finding>> RawSequences::ApartFolders() const {
  std::map<std::string, ViewNumbers> recordings;      // by the folder that the views lie in
  std::map<std::string, std::string> folder_of_view;  // views are named by their folder, or by the names of the files
  for (const auto& [name, folder] : folders_) {
    if (folder.keypoints.empty()) continue;
    const bool one = folder.frames.sequences().size() == 1;
    for (const auto& [key, sequence] : folder.frames.sequences()) {
      const std::string view = one ? name : key;
      for (const auto& [number, file] : sequence.files) recordings[one ? FolderOf(name) : name][view].insert(number);
      folder_of_view[view] = name;
    }
  }
  std::map<std::string, std::vector<Finding>> apart;
  for (const auto& [recording, views] : recordings) {
    for (const ApartView& view : FindApartViews(views)) {
      apart[folder_of_view.at(view.camera)].push_back(MakeFinding(
          "view_numbering", Severity::kWarning, static_cast<double>(view.offset()),
          view.Words() + ": a run refuses them as views of one recording; ingest.source.first_frame says which number "
                         "of the camera is the first moment of the others"));
    }
  }
  return apart;
}

Status RawSequences::AddOpenCv(const FileBytes& file) {
  folders_[FolderOf(file.name)].storages.emplace_back(file.name, std::string(file.bytes));
  return {};
}

void RawSequences::AddBeside(const FileBytes& file) {
  folders_[FolderOf(file.name)].beside.emplace_back(file.name, std::string(file.bytes));
}

void RawSequences::AddImage(const FileBytes& head, bool png) {
  RawCompanion image{FolderOf(head.name), png ? "png" : "jpeg", {}, {{"files", 1.0}}};
  if (png) {
    const PngHeader header = ReadPngHeader(head.bytes, head.name).value_or(PngHeader());
    image.numbers.emplace_back("width", header.width);
    image.numbers.emplace_back("height", header.height);
    image.numbers.emplace_back("bits", header.bits);
    image.numbers.emplace_back("channels", header.channels);
  }
  std::string key = image.format;
  for (std::size_t i = 1; i < image.numbers.size(); ++i) key += " " + std::to_string(image.numbers[i].second);
  auto [known, fresh] = folders_[image.file].images.emplace(key, image);
  if (!fresh) known->second.numbers[0].second += 1.0;
}

std::map<std::string, RawFile> RawSequences::Finish(bool of_folder) const {
  // Cameras of one recording stand in folders side by side and were given to the same detector.
  std::map<std::string, std::vector<OpenPosePerson>> everybody;
  for (const auto& [name, folder] : folders_) {
    for (const OpenPoseFrame& frame : folder.keypoints) {
      std::vector<OpenPosePerson>& people = everybody[FolderOf(name)];
      people.insert(people.end(), frame.people.begin(), frame.people.end());
    }
  }
  std::map<std::string, RawFile> files;
  std::map<std::string, std::vector<Finding>> apart = ApartFolders();
  for (const auto& [name, folder] : folders_) {
    RawFile file;
    for (const Finding& finding : apart[name]) file.remarks.push_back(finding);
    if (!folder.keypoints.empty()) {
      file.clips.push_back(ReadRawKeypoints(folder.keypoints, everybody[FolderOf(name)]));
      std::vector<ImagePoses> poses;
      for (const OpenPoseFrame& frame : folder.keypoints) {
        poses.emplace_back();
        for (const OpenPosePerson& person : frame.people) poses.back().push_back(person.pose);
      }
      if (const auto far = ExcludeFarKeypoints(folder.keypoint_files, poses)) file.remarks.push_back(*far);
      const auto odd = ExcludeImplausibleConfidences(folder.keypoint_files, poses);
      if (odd) file.remarks.push_back(*odd);
    }
    for (RawClip& clip : ReadRawPanoptic(folder.scenes)) file.clips.push_back(std::move(clip));
    const auto beside = folder.keypoints.empty() ? std::vector<const FrameNames*>() : FramesBeside(name);
    for (const Finding& finding : folder.frames.MissingFrames(beside)) file.remarks.push_back(finding);
    for (const Finding& finding : folder.unseen.Findings()) file.remarks.push_back(finding);
    for (const auto& [key, image] : folder.images) file.companions.push_back(image);
    if (!folder.storages.empty()) {
      Expected<Calibration> calibration = ParseOpenCvCalibration(folder.storages);
      for (std::size_t i = 0; !calibration && i < folder.beside.size(); ++i) {
        auto storages = folder.storages;
        storages.push_back(folder.beside[i]);
        // Together they may lack another field than one alone.
        auto together = ParseOpenCvCalibration(storages);
        if (together || together.error().where != calibration.error().where) calibration = std::move(together);
      }
      if (calibration) {
        file.calibrations.push_back(std::move(*calibration));
      } else {
        const bool other = calibration.error().code == ErrorCode::kUnsupported;
        file.remarks.push_back(MakeFinding(other ? "unknown_format" : "malformed",
                                           other && of_folder ? Severity::kInfo : Severity::kError, 0.0,
                                           calibration.error().Message()));
      }
    }
    files.emplace(name, std::move(file));
  }
  return files;
}

long long FrameNames::Sequence::first() const {
  return broken.empty() ? files.begin()->first : std::min(files.begin()->first, broken.begin()->first);
}

long long FrameNames::Sequence::last() const {
  return broken.empty() ? files.rbegin()->first : std::max(files.rbegin()->first, broken.rbegin()->first);
}

void FrameNames::Add(const std::string& name) {
  const auto numbered = Numbered(name);
  if (!numbered) return;
  const auto [first, fresh] = sequences_[numbered->first].files.emplace(numbered->second, name);
  if (!fresh) twice_.emplace_back(name, first->second);
}

bool FrameNames::AddBroken(const std::string& name, const Error& error) {
  const auto numbered = Numbered(name);
  const auto sequence = numbered ? sequences_.find(numbered->first) : sequences_.end();
  if (sequence == sequences_.end()) return false;
  sequence->second.broken.emplace(numbered->second, std::pair(name, error));
  return true;
}

std::vector<Finding> FrameNames::MissingFrames(const std::vector<const FrameNames*>& beside) const {
  std::map<std::pair<long long, long long>, int> spans;
  for (const FrameNames* names : beside) {
    for (const auto& [key, sequence] : names->sequences()) ++spans[{sequence.first(), sequence.last()}];
  }
  std::vector<Finding> findings;
  for (const auto& [name, other] : twice_) {
    findings.push_back(MakeFinding(
        "malformed", Severity::kError, 0.0,
        name + ": the same frame as " + other + " (one file per camera and frame is expected: leave one of them out)"));
  }
  for (const auto& [key, sequence] : sequences_) {
    long long first = sequence.first(), last = sequence.last();
    const auto common = std::find_if(spans.begin(), spans.end(), [&](const auto& span) {
      return span.second >= 2 && span.first.first <= first && span.first.second >= last;
    });
    if (common != spans.end()) std::tie(first, last) = common->first;
    // Numbers that count no frames: of takes, or of other things.
    if (last - first >= 2 * static_cast<long long>(sequence.files.size() + sequence.broken.size())) continue;
    MissingFrameList lacking;
    for (long long number = first; number <= last; ++number) {
      const int frame = static_cast<int>(number - first);
      const auto broken = sequence.broken.find(number);
      if (broken != sequence.broken.end()) {
        lacking.broken.push_back(frame);
        lacking.problems.push_back(broken->second);
      } else if (sequence.files.count(number) == 0) {
        lacking.missing.push_back(frame);
      }
    }
    NoteMissingFrames("", {first, static_cast<int>(last - first + 1)}, lacking, findings);
  }
  return findings;
}

}  // namespace mocurate
