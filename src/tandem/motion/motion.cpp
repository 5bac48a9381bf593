#include "tandem/motion/motion.h"
