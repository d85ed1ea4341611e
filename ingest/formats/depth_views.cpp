#include "ingest/formats/driver.h"
#include "ingest/grouped_files.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/sources/frame_files.h"
#include "ingest/sources/rig_calibration.h"

namespace mocurate {
namespace {

/// The file of a camera and frame. Error kNotFound.
Expected<const StageInput*> At(const std::map<std::string, FilesOfCamera>& cameras, const std::string& camera,
                               long long number, const char* what, const SourceFile& file) {
  const auto files = cameras.find(camera);
  if (files != cameras.end()) {
    const auto found = files->second.find(number);
    if (found != files->second.end()) return found->second;
  }
  return Fail(ErrorCode::kNotFound,
              "camera '" + camera + "' has no " + what + " of frame number " + std::to_string(number), file.name,
              "the other cameras have it; correct ingest.source.files, or complete the folder");
}

/// Depth images of one camera each, with calibration and masks -> depth views by reference.
Expected<IngestedClip> ReadDepthViewsClip(const SourceFile& file) {
  IngestedClip ingested;
  Expected<Rig> rig = ReadRig(file);
  if (!rig) return Forward(rig);
  ingested.findings = rig->findings;
  ingested.content = rig->content;
  auto cameras = SortByCamera(file.source.files, "ingest.source.files", file.depth_files);
  if (!cameras) return Forward(cameras);
  auto masks = SortByCamera(file.source.mask_files, "ingest.source.mask_files", file.depth_files);
  if (!masks) return Forward(masks);
  const auto partners = PartnersOf(file, *rig, *cameras, ingested.findings);
  if (!partners) return Forward(partners);
  KeepPartners(*partners, *cameras);
  KeepPartners(*partners, *masks);
  const Expected<FrameSpan> span = MatchViews(file, *cameras, nullptr, &*masks);
  if (!span) return Forward(span);
  Clip& clip = ingested.clip;
  clip.rate = FrameRate::FromHz(*file.source.rate_hz);
  for (const auto& [name, camera] : *partners) {
    DepthView view;
    view.camera = *camera;
    view.camera.name = name;
    view.metres_per_unit = file.source.depth_unit;
    DepthView masked;
    for (int f = 0; f < span->frames; ++f) {
      const auto image = At(*cameras, name, span->first + f, "depth image", file);
      if (!image) return Forward(image);
      if (f == 0) {
        if (Status sized = SetImageSize(**image, view.camera); !sized) return Forward(sized);
      }
      const double time_s = clip.rate.FrameTime(f);
      if (Status added = AddDepthImage(**image, time_s, view); !added) return Forward(added);
      if (file.source.mask_files.empty()) continue;
      const auto mask = At(*masks, name, span->first + f, "mask", file);
      if (!mask) return Forward(mask);
      if (Status added = AddDepthImage(**mask, time_s, masked); !added) return Forward(added);
    }
    view.masks = std::move(masked.files);
    view.mask_sha256 = std::move(masked.sha256);
    clip.evidence.depth_views.push_back(std::move(view));
  }
  clip.provenance["calibration"] = rig->meaning;
  return ingested;
}

}  // namespace

FormatDriver DepthViewsFormat() {
  FormatDriver d;
  d.name = "depth_views";
  d.gives = EvidenceKind::kDepthViews;
  d.unit = UnitOf::kCalibration;
  d.grouped_by = {"camera"};
  d.check = CheckGrouped;
  d.options = {"calibration", "camera_pose", "cameras", "first_frame", "mask_files", "depth_unit"};
  d.propose = ProposeDepthViews;
  d.to_clip = ReadDepthViewsClip;
  return d;
}

}  // namespace mocurate
