#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// Inputs: role "run" (run summary JSON), "dataset", "metrics", "fit_error", "evidence" and "fit" of the clips to draw
/// -> one self-contained HTML page.
Expected<StageOutcome> ReportStage(const StageRequest& request);

/// One fitted clip (roles "evidence", "fit", "depth") -> an HTML page about it.
Expected<StageOutcome> ClipPageStage(const StageRequest& request);

/// The same -> an H.264 video (MP4). It has a library and program of its own (report_video, mocurate-video), because
/// video coders load some 200 libraries. Error kMissingOnHost without an encoder.
Expected<StageOutcome> ClipVideoStage(const StageRequest& request);

/// Sets of motions (role "motions", named after their source; role "body": a skin to draw them with) -> SVG or PNG.
Expected<StageOutcome> MotionPictureStage(const StageRequest& request);

/// Sets of motions as for MotionPictureStage -> an H.264 video, all rows side by side (report_video).
Expected<StageOutcome> MotionVideoStage(const StageRequest& request);

/// Inputs: roles "dataset", "audit" (its audit.json) and, after earlier decisions, "decisions" (a JSON list) -> the
/// page. Clips are read one at a time. Error kMalformed for an audit.json of another program; findings about unknown
/// clips are skipped and counted.
Expected<StageOutcome> ReviewStage(const StageRequest& request);

/// Inputs: role "motions", datasets or MotionSets, each named by its source; role "body", a skin to draw the motions
/// with instead of bones -> the page. The summary has the key ("key"), what was shown and what may reveal sources
/// ("notes"). All motions have the lowest rate of all, at most 30 Hz, and those of a question last as long as its
/// shortest, at most options.seconds. Errors: those of DrawSurvey, ReadSkin and of reading; kUnsupported for a motion
/// without rotations where there is a body.
Expected<StageOutcome> SurveyStage(const StageRequest& request);

/// Sets of motions (role "motions", named after their source; "evidence of SOURCE": evidence, by its recording, and
/// "depth of SOURCE", the files that it refers to; "audit of SOURCE": its audit.json; "truth of SOURCE"; "body": a
/// skin)
/// -> a folder with index.html, a page of the viewer, and, where options.page_bytes is exceeded,
/// part_0000.js and so on, which belong into the folder `beside` the page. Clips are read one at a time. Errors of
/// reading; kNotFound for an unknown clip, kInconsistent where no clip has a motion or a body does not fit.
Expected<StageOutcome> ViewStage(const StageRequest& request);

/// Inputs: roles "dataset" and, if there is an earlier session, "spans" (its table, core/formats/span_table.h)
/// -> the page. Spans of the session replace the segments of the recordings that they name. Clips are read one at a
/// time; poses are fifteen a second, or fewer where all exceed options.poses_bytes. Errors: kUsage for an unknown clip,
/// kInconsistent when no clip is to be shown, or when no span is of a recording of the dataset; of ParseSpanTable.
Expected<StageOutcome> AnnotateStage(const StageRequest& request);

/// What the runner must know of each stage; versions are in options.cpp.
StageDeclaration MotionPictureDeclaration();
StageDeclaration MotionVideoDeclaration();
StageDeclaration ClipPageDeclaration();
StageDeclaration ClipVideoDeclaration();
StageDeclaration ReportDeclaration();
StageDeclaration ReviewDeclaration();
StageDeclaration AnnotateDeclaration();
StageDeclaration SurveyDeclaration();
StageDeclaration ViewDeclaration();

}  // namespace mocurate
