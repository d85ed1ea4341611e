#include "eval/features/extractor_options.h"

namespace mocurate {
namespace {

void DeclareRoot(const char* name, RootRule& rule, const char* help, OptionVisitor& v) {
  v.Choice(name, rule,
           {{"as_given", RootRule::kAsGiven},
            {"first_frame", RootRule::kFirstFrame},
            {"every_frame", RootRule::kEveryFrame}},
           help);
}

}  // namespace

void ExtractorOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the extractor");
  v.Text("weights", weights,
         "weights file: a path, or a name below the folder MOCURATE_WEIGHTS; a checkpoint of "
         "mocurate needs no other option");
  v.Text("obtain", obtain, "where the weights come from");
  v.Choice("network", network, {{"gru", ExtractorNetwork::kGru}, {"st_gcn", ExtractorNetwork::kStGcn}},
           "network of the weights");
  v.Choice("values", values,
           {{"joints", ExtractorValues::kJoints}, {"rotation_6d_rows", ExtractorValues::kRotation6DRows}},
           "network input of a frame");
  v.Text("skeleton", skeleton, "joints in the network's order: a name below configs/skeletons, or a YAML file");
  v.Text("axes", axes, "directions of the network's +x, +y and +z in canonical axes: '+x -y -z' is y down, facing -z");
  v.Number("metres_per_unit", metres_per_unit, Unit::kNone, {1e-6, 1e6}, "length of the network's unit");
  v.Number("rate", rate_hz, Unit::kHertz, {0.0, 1000.0},
           "rate of the training motions; other rates are a warning; 0: unknown");
  v.Integer("frames", frames, {2.0, 10000.0}, "frames that the network reads");
  v.Choice("length", length, {{"crop", LengthRule::kCrop}, {"resample", LengthRule::kResample}},
           "conversion of a motion of another length to `frames`: a window with padding, or resampling");
  v.Choice("padding", padding,
           {{"repeat_last", PaddingRule::kRepeatLast},
            {"zeros", PaddingRule::kZeros},
            {"zeros_minus_root", PaddingRule::kZerosMinusRoot}},
           "padding of a motion that is too short");
  v.Choice("read_out", read_out, {{"last_frame", ReadOut::kLastFrame}, {"last_valid", ReadOut::kLastValid}},
           "frame whose output is used: the last one including padding, or the last of the motion");
  DeclareRoot("real_root", real_root, "origin of the joints of real motions", v);
  DeclareRoot("generated_root", generated_root, "origin of the joints of generated motions", v);
  v.Choice("body", body, {{"own", BodyRule::kOwn}, {"mean_shape", BodyRule::kMeanShape}},
           "bone lengths of the joints: the motion's own, or those of SMPL's mean body");
  v.Number("yaw", yaw_rad, Unit::kRadian, {-7.0, 7.0},
           "rotation of the scored motions, not of the reference, about the vertical: shows how much a network depends "
           "on the "
           "view");
  v.Texts("classes", classes, "class names in the order of the network's outputs");
}

}  // namespace mocurate
