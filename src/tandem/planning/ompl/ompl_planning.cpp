#include "tandem/planning/ompl/ompl_planning.h"
