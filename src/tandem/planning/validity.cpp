#include "tandem/planning/validity.h"
