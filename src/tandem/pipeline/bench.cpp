#include "tandem/pipeline/bench.h"
