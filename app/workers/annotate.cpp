// Worker program for everything that needs no libtorch: ingesting, fitting, canonicalising, reporting.

#include <cstring>

#include "canon/options.h"
#include "canon/stages.h"
#include "core/base/terminal.h"
#include "core/base/version.h"
#include "core/pipeline/worker.h"
#include "eval/options.h"
#include "eval/stages.h"
#include "fitting/options.h"
#include "fitting/stages.h"
#include "ingest/options.h"
#include "ingest/read_motions.h"
#include "ingest/stages.h"
#include "report/options.h"
#include "report/stages.h"

int main(int argc, char** argv) {
  using namespace mocurate;
  if (argc == 2 && std::strcmp(argv[1], "--version") == 0) {
    Print("%s\n", std::string(CreatedBy()).c_str());
    return 0;
  }
  return RunWorker({{CaptureDeclaration().name, CaptureStage},
                    {TruthDeclaration().name, TruthStage},
                    {IngestDeclaration().name, IngestStage},
                    {MotionsDeclaration().name, MotionsStage},
                    {DuplicatesDeclaration().name, DuplicatesStage},
                    {RigDeclaration().name, RigStage},
                    {ProportionsDeclaration().name, ProportionsStage},
                    {FittingDeclaration().name, FittingStage},
                    {LevelDeclaration().name, LevelStage},
                    {CanonDeclaration().name, CanonStage},
                    {AssembleDeclaration().name, AssembleStage},
                    {AuditDeclaration().name, AuditStage},
                    {FitErrorDeclaration().name, FitErrorStage},
                    {ReportDeclaration().name, ReportStage},
                    {MotionPictureDeclaration().name, MotionPictureStage},
                    {ClipPageDeclaration().name, ClipPageStage},
                    {ReviewDeclaration().name, ReviewStage},
                    {AnnotateDeclaration().name, AnnotateStage},
                    {SurveyDeclaration().name, SurveyStage},
                    {ViewDeclaration().name, ViewStage}});
}
