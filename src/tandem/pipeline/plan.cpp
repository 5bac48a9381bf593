#include "tandem/pipeline/plan.h"
