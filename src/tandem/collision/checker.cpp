#include "tandem/collision/checker.h"
