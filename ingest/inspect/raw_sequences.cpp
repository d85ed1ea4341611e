#include <string>

#include "core/formats/camera_files.h"
#include "core/formats/png.h"
#include "ingest/checks/keypoint_checks.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/keypoint_layout_estimate.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/frame_files.h"

namespace mocurate {

Status RawSequences::AddOpenPose(const FileBytes& file) {
  Expected<OpenPoseFrame> frame = ParseOpenPose(file.bytes, file.name);
  if (!frame) return Forward(frame);
  Folder& folder = folders_[FolderOf(file.name)];
  folder.unsure.Add(frame->uncertain_points, file.name);
  folder.not_finite.Add(frame->not_finite, file.name);
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
    if (folder.unsure.points > 0) {
      file.remarks.push_back(MakeFinding("uncertain_points", Severity::kWarning,
                                         static_cast<double>(folder.unsure.points), UnsurePointsWords(folder.unsure)));
    }
    if (folder.not_finite.points > 0) {
      file.remarks.push_back(MakeFinding("keypoints_not_finite", Severity::kWarning,
                                         static_cast<double>(folder.not_finite.points),
                                         NotFiniteWords(folder.not_finite)));
    }
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

}  // namespace mocurate
