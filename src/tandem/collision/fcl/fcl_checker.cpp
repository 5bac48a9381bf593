#include "tandem/collision/fcl/fcl_checker.h"
